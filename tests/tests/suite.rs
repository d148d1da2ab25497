//! All tests that run programs, in one binary: while processes of one run wait for each other, other runs go on.
//! `cargo test --release -p halfstep-tests --test suite waves::` runs those of `waves.rs`.

mod baselines;
mod bit_identity;
mod block_wall;
mod body_probes;
mod breaking_wall;
mod clients;
mod colliding_rings;
mod command_line;
mod compare;
mod crates;
mod crumbs;
mod csm3;
mod dam_break;
mod dam_break_plate;
mod debris;
mod dimension;
mod dry_cracks;
mod elastic_friction;
mod elastic_gate;
mod energy_ledger;
mod explain;
mod external_solid;
mod external_solids;
mod external_walls;
mod failure;
mod fake_fluid;
mod floating_box;
mod frame;
mod hanging_bar;
mod hydrostatic_plate;
mod hydrostatic_tank;
mod interface_limits;
mod interface_viscosity;
mod link;
mod link_processes;
mod many_probes;
mod oscillating_plate;
mod output_paths;
mod pair_contact;
mod paper_plate;
mod partners;
mod precision;
mod prescribed_motion;
mod price_lists;
mod protocol_page;
mod python_package;
mod restitution;
mod resume;
mod riding;
mod set_ups;
mod setup;
mod several_runs;
mod solitary_wall;
mod spring_block;
mod squeezed_block;
mod stability;
mod study;
mod system_functions;
mod thin_plates;
mod time_order;
mod timeline;
mod tips;
mod torture;
mod tutorial;
mod two_plates;
mod verlet;
mod viscous_flow;
mod water;
mod waves;

#[test]
fn every_file_is_in_the_suite() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let names = std::fs::read_dir(folder).expect("the tests").map(|entry| entry.expect("a file").path());
    for path in names.filter(|path| path.extension().is_some_and(|ending| ending == "rs")) {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(name == "suite" || include_str!("suite.rs").contains(&format!("mod {name};")), "{name}");
    }
}

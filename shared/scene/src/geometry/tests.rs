use super::*;
use crate::*;
use approx::assert_relative_eq;
use std::collections::BTreeMap;

pub(super) const DX: f64 = 0.1;

pub(in crate::geometry) fn scene(shapes: Vec<Shape>) -> Scene {
    Scene {
        name: "test".into(),
        path: "test.toml".into(),
        preset: None,
        dimension: 2,
        resolution: DX,
        smoothing_ratio: 1.33,
        end_time: 1.0,
        whole: None,
        time_step: TimeStep::Auto,
        gravity: [0.0, -10.0, 0.0],
        fluid: Some(Fluid {
            density: 1000.0,
            viscosity: 0.0,
            sound_speed: 10.0,
            artificial_viscosity: ArtificialViscosity { linear: 0.1, quadratic: 0.0 },
            density_diffusion: DensityDiffusion::DeltaSph,
            density_diffusion_coefficient: 0.1,
            background_pressure: 0.0,
            time_integration: FluidIntegration::Midpoint,
            beach: None,
        }),
        solids: vec![Solid {
            name: "solid".into(),
            process: "solid".into(),
            threads: 1,
            density: 1000.0,
            youngs_modulus: 2e6,
            poissons_ratio: 0.3975,
            smoothing_ratio: 1.33,
            artificial_viscosity: ArtificialViscosity { linear: 1.0, quadratic: 1.0 },
            model: ModelKeys::Hypoelastic(HypoelasticKeys {
                artificial_stress: ArtificialStress { strength: 0.3, exponent: 4.0 },
                contact: None,
            }),
            side_friction: 0.0,
            sub_steps: SubSteps::Auto,
        }],
        interface: Interface {
            treatment: Treatment::MovingWall,
            cross_viscosity: 1.0,
            cross_viscosity_far: 1.0,
            cross_viscosity_reach: 1.25,
        },
        output: Output { frame_interval: 0.1, probe_interval: 0.1, checkpoint_interval: 0.0 },
        pair_contacts: Vec::new(),
        shapes,
        voids: Vec::new(),
        probes: Vec::new(),
        references: Vec::new(),
        metrics: Vec::new(),
        effects: BTreeMap::new(),
        own_effects: BTreeMap::new(),
        numerics: Numerics {
            kernel: KernelName::CubicSpline,
            precision: Precision::Double,
            cfl: 0.25,
            solid_cfl: 0.6,
            max_sub_steps: 200,
            interface_capacity: None,
            threads: Threads { fluid: 1, solid: 1 },
            lattice: Lattice::Centred,
            domain: None,
        },
        frame: None,
        doubtful: Default::default(),
    }
}

pub(super) fn shape(phase: Phase, geometry: Geometry) -> Shape {
    Shape {
        spacing: None,
        lattice_angle: 0.0,
        name: "shape".into(),
        phase,
        solid: (phase == Phase::Solid).then_some(0),
        geometry,
        density: None,
        velocity: [0.0; 3],
        cantilever_mode: None,
        velocity_field: None,
        clamp_with: Vec::new(),
        load: None,
        crack: None,
        body: String::new(),
        clamp: Vec::new(),
        motion: None,
        contact: false,
        free_slip: true,
        hydrostatic: false,
    }
}

pub(super) fn block(min: [f64; 2], max: [f64; 2]) -> Block {
    Block { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] }
}

pub(super) fn a_box(phase: Phase, min: [f64; 2], max: [f64; 2]) -> Shape {
    shape(phase, Geometry::Box(block(min, max)))
}

pub(super) fn tank(open: &[TankSide]) -> Shape {
    let cavity = block([0.0, 0.0], [1.0, 0.5]);
    shape(Phase::Wall, Geometry::Tank { cavity, open: open.to_vec() })
}

pub(super) fn wall_at(layout: &Layout<2>, x: f64, y: f64) -> Option<WallPoint<2>> {
    let close = |p: &[f64; 2]| (p[0] - x).abs() < 1e-9 && (p[1] - y).abs() < 1e-9;
    layout.wall.iter().copied().find(|p| close(&p.position))
}

#[test]
fn a_box_holds_its_cells_centres_row_by_row() {
    let got = layout::<2>(&scene(vec![a_box(Phase::Fluid, [1.0, 2.0], [1.3, 2.2])])).fluid;
    let want = [[1.05, 2.05], [1.15, 2.05], [1.25, 2.05], [1.05, 2.15], [1.15, 2.15], [1.25, 2.15]];
    assert_eq!(got.len(), want.len());
    for (got, want) in got.iter().zip(want) {
        assert_relative_eq!(got.position[..], want[..], max_relative = 1e-12);
    }
}

#[test]
fn nodal_material_has_one_row_less_than_cells() {
    // 146 x 292 mm at 2 mm: 72 x 145 particles; 12 mm x 292 mm: 5 x 145.
    let mut s = scene(vec![
        a_box(Phase::Fluid, [0.0, 0.0], [0.146, 0.292]),
        a_box(Phase::Solid, [0.286, 0.0], [0.298, 0.292]),
    ]);
    s.resolution = 0.002;
    s.numerics.lattice = Lattice::Nodal;
    let l = layout::<2>(&s);
    assert_eq!((l.fluid.len(), l.solid.len()), (72 * 145, 5 * 145));
    assert_relative_eq!(l.fluid[0].position[..], [0.002, 0.002][..], max_relative = 1e-12);
    assert_eq!(estimate(&s), Counts { fluid: 72 * 145, solid: 5 * 145, wall: 0 });
}

#[test]
fn three_dimensions_have_x_innermost_and_z_outermost() {
    let mut s = scene(vec![a_box(Phase::Fluid, [0.0, 0.0], [0.2, 0.2])]);
    s.dimension = 3;
    let Geometry::Box(b) = &mut s.shapes[0].geometry else { unreachable!() };
    b.max[2] = 0.2;
    let l = layout::<3>(&s);
    assert_eq!(l.fluid.len(), 8);
    assert_relative_eq!(l.fluid[1].position[..], [0.15, 0.05, 0.05][..], max_relative = 1e-12);
    assert_relative_eq!(l.fluid[4].position[..], [0.05, 0.05, 0.15][..], max_relative = 1e-12);
    assert_eq!(estimate(&s).fluid, 8);
}

#[test]
fn a_disc_is_symmetric_about_its_centre() {
    // Radius 1.5 dx: half-integer places with k² + l² <= 2.25 are the four at (±1/2, ±1/2) only, and (±3/2, ±1/2)
    // has 2.5 > 2.25.
    let disc = Geometry::Disc { center: [0.3, 0.7, 0.0], radius: 0.15 };
    let l = layout::<2>(&scene(vec![shape(Phase::Solid, disc)]));
    let sum = l.solid.iter().fold([0.0, 0.0], |s, p| [s[0] + p.position[0], s[1] + p.position[1]]);
    assert_eq!(l.solid.len(), 4);
    assert_relative_eq!(sum[0] / 4.0, 0.3, max_relative = 1e-12);
    assert_relative_eq!(sum[1] / 4.0, 0.7, max_relative = 1e-12);
}

#[test]
fn a_ring_wall_has_radial_normals_out_of_the_nearer_surface() {
    let ring = Geometry::Ring { center: [0.0; 3], inner: 0.5, outer: 1.0 };
    let s = scene(vec![shape(Phase::Wall, ring)]);
    let l = layout::<2>(&s);
    for p in &l.wall {
        let radius = p.position[0].hypot(p.position[1]);
        assert!((0.5..=1.0).contains(&radius) && !p.corner);
        let outward = if radius < 0.75 { -1.0 } else { 1.0 };
        assert_relative_eq!(p.normal[0], outward * p.position[0] / radius, epsilon = 1e-12);
        assert_relative_eq!(p.normal[1], outward * p.position[1] / radius, epsilon = 1e-12);
    }
    // Area of the ring over dx²: 235.6.
    assert_eq!(estimate(&s).wall, 236);
    assert!((l.wall.len() as i64 - 236).abs() < 12, "{}", l.wall.len());
}

#[test]
fn a_tank_has_three_layers_with_corners_where_two_closed_sides_meet() {
    // 2 h = 2.66 dx: 3 layers around 10 x 5 cells.
    let s = scene(vec![tank(&[])]);
    let l = layout::<2>(&s);
    assert_eq!(l.wall.len(), 16 * 11 - 50);
    assert_eq!(estimate(&s).wall, 16 * 11 - 50);
    assert_eq!(l.wall.iter().filter(|p| p.corner).count(), 4 * 9);
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!(normal(0.05, -0.25), Some(([0.0, 1.0], false)));
    assert_eq!(normal(0.95, 0.55), Some(([0.0, -1.0], false)));
    assert_eq!(normal(-0.05, 0.05), Some(([1.0, 0.0], false)));
    assert_eq!(normal(1.25, 0.45), Some(([-1.0, 0.0], false)));
    let half = 0.5_f64.sqrt();
    let (n, corner) = normal(-0.25, 0.55).unwrap();
    assert!(corner);
    assert_relative_eq!(n[..], [half, -half][..], max_relative = 1e-12);
}

#[test]
fn an_open_tank_ends_at_the_cavitys_edge() {
    let s = scene(vec![tank(&[TankSide::Top])]);
    let l = layout::<2>(&s);
    // Floor with both corners: 16 x 3; two sides: 3 x 5 each.
    assert_eq!(l.wall.len(), 48 + 30);
    assert_eq!(estimate(&s).wall, 78);
    assert!(l.wall.iter().all(|p| p.position[1] < 0.5));

    let l = layout::<2>(&scene(vec![tank(&[TankSide::Left, TankSide::Right, TankSide::Top])]));
    assert_eq!(l.wall.len(), 10 * 3);
    assert!(l.wall.iter().all(|p| !p.corner && p.normal == [0.0, 1.0]));
}

#[test]
fn a_nodal_tank_carries_its_surface() {
    let mut s = scene(vec![tank(&[TankSide::Top])]);
    s.numerics.lattice = Lattice::Nodal;
    let l = layout::<2>(&s);
    // x: -3..=13, y: -3..=5; the cavity 1..=9 x 1..=5 is left free.
    assert_eq!(l.wall.len(), 17 * 9 - 9 * 5);
    assert_eq!(estimate(&s).wall, 17 * 9 - 9 * 5);
    assert_eq!(wall_at(&l, 0.5, 0.0).map(|p| (p.normal, p.corner)), Some(([0.0, 1.0], false)));
    assert!(wall_at(&l, 0.0, 0.0).is_some_and(|p| p.corner));
    assert!(wall_at(&l, 1.0, 0.5).is_some_and(|p| p.normal == [-1.0, 0.0]));
}

#[test]
fn a_wall_box_turns_to_its_nearest_face() {
    let l = layout::<2>(&scene(vec![a_box(Phase::Wall, [0.0, 0.0], [1.0, 0.4])]));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!(normal(0.55, 0.05), Some(([0.0, -1.0], false)));
    assert_eq!(normal(0.55, 0.35), Some(([0.0, 1.0], false)));
    assert_eq!(normal(0.05, 0.15), Some(([-1.0, 0.0], false)));
    assert_eq!(normal(0.95, 0.15), Some(([1.0, 0.0], false)));
    // Water flows round the corner: it stands for the diagonal.
    let half = 1.0 / 2.0_f64.sqrt();
    assert_eq!(normal(0.15, 0.15), Some(([-half, -half], false)));
    assert!(normal(0.25, 0.15).is_some_and(|(n, corner)| n == [0.0, -1.0] && !corner));
}

#[test]
fn a_solid_cuts_walls_and_fluid_but_leaves_neighbours_at_dx() {
    // The plate's foot goes 0.3 into the floor; water stands over everything.
    let s = scene(vec![
        tank(&[TankSide::Top]),
        a_box(Phase::Fluid, [0.0, 0.0], [1.0, 0.3]),
        a_box(Phase::Solid, [0.4, -0.3], [0.6, 0.4]),
    ]);
    let l = layout::<2>(&s);
    assert_eq!(l.solid.len(), 2 * 7);
    assert_eq!(l.wall.len(), 78 - 2 * 3);
    assert_eq!(l.fluid.len(), 30 - 2 * 3);
    assert!(wall_at(&l, 0.35, -0.05).is_some() && wall_at(&l, 0.45, -0.05).is_none());
}

#[test]
fn a_solid_off_the_lattice_leaves_no_wall_particle_in_it() {
    // Half a spacing off in both axes: wall particles sit between four solid ones, 0.71 dx away.
    let s = scene(vec![tank(&[TankSide::Top]), a_box(Phase::Solid, [0.35, -0.25], [0.65, 0.25])]);
    let l = layout::<2>(&s);
    assert!(!l.wall.iter().any(|p| (0.36..0.64).contains(&p.position[0]) && p.position[1] > -0.24));
    assert!(
        wall_at(&l, 0.35, -0.05).is_some(),
        "a particle on the plate's surface, 0.5 sqrt(2) dx away, stays"
    );
}

#[test]
fn the_cut_is_half_a_spacing() {
    // A solid of one particle at (0.05, 0.05); the first wall particle at (0.05 + gap, 0.05).
    for (gap, kept) in [(0.0499, false), (0.05, true), (0.1, true)] {
        let s = scene(vec![
            a_box(Phase::Solid, [0.0, 0.0], [0.1, 0.1]),
            a_box(Phase::Wall, [gap, 0.0], [gap + 0.1, 0.1]),
        ]);
        assert_eq!(layout::<2>(&s).wall.len(), kept as usize, "{gap}");
    }
}

#[test]
fn no_fluid_in_a_wall_and_no_particle_twice() {
    let s = scene(vec![
        a_box(Phase::Fluid, [-0.3, -0.3], [1.0, 0.3]),
        a_box(Phase::Fluid, [0.0, 0.0], [1.0, 0.4]),
        tank(&[TankSide::Top]),
        a_box(Phase::Wall, [0.0, -0.3], [1.0, 0.0]),
    ]);
    let l = layout::<2>(&s);
    assert_eq!(l.wall.len(), 78);
    assert_eq!(l.fluid.len(), 40);
    assert!(l.fluid.iter().all(|p| p.position.iter().all(|x| *x > 0.0)));
}

#[test]
fn hydrostatic_pressure_grows_from_the_shapes_highest_point() {
    let mut s = scene(vec![a_box(Phase::Fluid, [0.0, 1.0], [0.2, 1.4])]);
    s.shapes[0].hydrostatic = true;
    s.shapes[0].velocity = [3.0, 0.0, 0.0];
    let l = layout::<2>(&s);
    assert_relative_eq!(l.fluid[0].pressure, 1000.0 * 10.0 * 0.35, max_relative = 1e-12);
    assert_relative_eq!(l.fluid[7].pressure, 1000.0 * 10.0 * 0.05, max_relative = 1e-12);
    assert_eq!(l.fluid[0].velocity, [3.0, 0.0]);
    // Tilted: the highest point is the corner at the top left.
    s.gravity = [6.0, -8.0, 0.0];
    let want = 1000.0 * (6.0 * 0.05 + 8.0 * 0.35);
    assert_relative_eq!(layout::<2>(&s).fluid[0].pressure, want, max_relative = 1e-12);
    s.shapes[0].hydrostatic = false;
    assert_eq!(layout::<2>(&s).fluid[0].pressure, 0.0);
}

#[test]
fn a_velocity_field_adds_to_the_shapes_velocity_and_brings_its_pressure() {
    let mut water = a_box(Phase::Fluid, [0.0, 0.0], [1.0, 1.0]);
    water.velocity = [0.5, 0.0, 0.0];
    let field = VelocityField::TaylorGreen { speed: 2.0, origin: [0.0; 3], half_wave: 1.0 };
    water.velocity_field = Some(field);
    water.hydrostatic = true;
    let fluid = layout::<2>(&scene(vec![water])).fluid;
    for p in &fluid {
        let [u, v] = field.velocity(p.position, 10.0);
        assert_eq!(p.velocity, [0.5 + u, v]);
        let at_rest = 1000.0 * 10.0 * (1.0 - p.position[1]);
        let want = at_rest + field.pressure(p.position, 1000.0);
        assert_relative_eq!(p.pressure, want, max_relative = 1e-12);
    }
    let energy: f64 = fluid.iter().map(|p| (p.velocity[0] - 0.5).powi(2) + p.velocity[1].powi(2)).sum();
    // The mean of u² + v² over a cell is U² / 2.
    assert_relative_eq!(energy / fluid.len() as f64, 2.0, max_relative = 1e-12);
}

#[test]
fn clamped_particles_rest_and_the_others_swing() {
    let mut plate = a_box(Phase::Solid, [-0.2, 0.0], [0.4, 0.1]);
    plate.clamp = vec![block([-0.2, 0.0], [0.0, 0.1])];
    plate.velocity = [0.0, 1.0, 0.0];
    plate.cantilever_mode = Some(CantileverMode { fraction: 0.01, root: 0.0, length: 0.4 });
    let l = layout::<2>(&scene(vec![plate]));
    let clamped: Vec<bool> = l.solid.iter().map(|p| p.clamped).collect();
    assert_eq!(clamped, [true, true, false, false, false, false]);
    assert_eq!(l.solid[1].velocity, [0.0, 0.0]);
    // (cosh z - cos z - 0.734096 (sinh z - sin z)) / 2 with z = 1.875104 x / L at x / L = 0.625.
    assert_relative_eq!(l.solid[4].velocity[1], 1.0 + 0.01 * C0 * 0.492947, max_relative = 1e-5);
}

/// sqrt(K / rho) = sqrt(2e6 / (3 (1 - 0.795)) / 1000).
const C0: f64 = 57.026_6;

#[test]
fn the_first_mode_follows_the_tables() {
    // Young and Felgar: the clamped-free beam's first mode over its tip value, at x / L = 0, 0.5, 1.
    let mode = CantileverMode { fraction: 0.01, root: 0.1, length: 0.2 };
    assert_eq!(cantilever_velocity(&mode, C0, 0.1), 0.0);
    assert_eq!(cantilever_velocity(&mode, C0, 0.05), 0.0, "behind the root");
    assert_relative_eq!(cantilever_velocity(&mode, C0, 0.2), 0.01 * C0 * 0.339_52, max_relative = 1e-4);
    assert_relative_eq!(cantilever_velocity(&mode, C0, 0.3), 0.01 * C0, max_relative = 1e-12);
}

#[test]
fn the_domain_is_three_times_the_box_of_all_shapes() {
    let mut s = scene(vec![
        a_box(Phase::Fluid, [0.0, 0.0], [1.0, 0.5]),
        shape(Phase::Solid, Geometry::Disc { center: [1.0, 0.5, 0.0], radius: 0.5 }),
    ]);
    let got = domain(&s);
    assert_relative_eq!(got.min[..], [-1.5, -1.0, 0.0][..], max_relative = 1e-12);
    assert_relative_eq!(got.max[..], [3.0, 2.0, 0.0][..], max_relative = 1e-12);
    s.shapes.push(tank(&[TankSide::Top]));
    assert_relative_eq!(domain(&s).min[0], -0.3 - 1.8, max_relative = 1e-12);
    s.numerics.domain = Some(block([7.0, 7.0], [8.0, 8.0]));
    assert_eq!(domain(&s), block([7.0, 7.0], [8.0, 8.0]));
}

#[test]
fn absurd_resolutions_are_counted_not_overflown() {
    for resolution in [1e-12, 1e-200, f64::MIN_POSITIVE] {
        let mut s = scene(vec![
            a_box(Phase::Fluid, [0.0, 0.0], [1.0, 0.5]),
            shape(Phase::Solid, Geometry::Disc { center: [0.0; 3], radius: 0.5 }),
            tank(&[]),
        ]);
        s.resolution = resolution;
        let counts = estimate(&s);
        assert!(
            counts.fluid > 1e18 as u64 && counts.solid > 1e18 as u64 && counts.wall > 1e12 as u64,
            "{counts:?}"
        );
        assert!(counts.total() >= counts.fluid);
    }
}

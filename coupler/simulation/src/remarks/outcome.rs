//! Remarks on how a run went.

use halfstep_output::RunReport;
use halfstep_output::run_json::{ContactReport, ProbeReport, WALLS};
use halfstep_scene::{EnergyPart, ProbeKind, Scene, Shape};

/// Density error that a weakly compressible fluid should stay below.
const DENSITY_ERROR: f64 = 0.03;
/// Distance of fluid and solid particles that says that one went into the other, over the mean spacing.
const CLOSEST: f64 = 0.1;

/// Part of the fluid under tension that says that something pulls at it: splashes have less.
const TENSION: f64 = 0.04;

/// Energy that a contact may give to two solids, over its largest force times its largest penetration.
const CREATED: f64 = 0.1;

/// Penetration over the smallest side of two solids from which on neither is where it should be.
pub(crate) const DEEP: f64 = 0.1;

/// Energy that fracture may take without a cut, over that of a crack through the smallest side.
const WITHOUT_CUT: f64 = 1.0;
/// Energy that fracture may take over that of the area that it opened.
const BESIDE_CRACKS: f64 = 3.0;

/// Single particles from which on debris is rubble, if they are more than half of all bodies.
const RUBBLE: f64 = 10.0;

/// Part of the largest energy that the ledger may leave to the error of time integration.
const RESIDUAL: f64 = 0.05;

/// Joints of a solid whose ends begin with different velocities, m/s and rad/s.
pub(crate) fn jerked(solid: &str, joints: &[(String, [f64; 2])]) -> Vec<String> {
    let told = joints.iter().map(|(joint, [apart, turned])| {
        format!(
            "the ends of the joint `{joint}` of the {solid} begin with velocities that differ by {apart:.2e} m/s and \
             {turned:.2e} rad/s: the first step takes that by an impulse, and its energy with it"
        )
    });
    told.collect()
}

/// What at the end of a run says that its result is not to be trusted as it is.
pub fn outcome(scene: &Scene, report: &RunReport) -> Vec<String> {
    let mut all = Vec::new();
    let (removed, fluid) = (report.particles.removed, report.particles.fluid);
    if removed > 0 {
        all.push(format!("{removed} of {fluid} fluid particles left the domain"));
    }
    if let Some(error) = report.audit.density_error.filter(|error| *error > DENSITY_ERROR) {
        all.push(format!(
            "density error up to {:.0} %: the fluid was compressed or torn somewhere",
            100.0 * error
        ));
    }
    if let Some(gap) = report.audit.min_gap.filter(|gap| *gap < CLOSEST) {
        all.push(format!("fluid and solid came as close as {gap:.3} dx"));
    }
    if let Some(tension) = report.audit.tension.filter(|tension| *tension > TENSION) {
        all.push(format!(
            "{:.1} % of the fluid is under tension at the end: it would rather part",
            100.0 * tension
        ));
    }
    for own in &report.participants {
        all.extend(jerked(&own.name, &own.jerked_joints));
    }
    for (own, (joint, apart)) in
        report.participants.iter().flat_map(|own| own.open_joints.iter().map(move |j| (own, j)))
    {
        all.push(format!(
            "the joint `{joint}` of the {} is {apart:.3} m open at the end: what holds its body otherwise, or moves \
             the other end, contradicts it, and neither is right",
            own.name
        ));
    }
    for own in report.participants.iter().filter(|own| own.outside > 0) {
        all.push(format!(
            "{} of {} particles of the {} left the domain",
            own.outside, own.particles, own.name
        ));
    }
    all.extend(report.external.iter().flat_map(|first| first.remarks(scene.dimension)));
    let moving = |shape: &Shape| shape.contact && (shape.motion.is_some() || shape.velocity != [0.0; 3]);
    let driven = scene.shapes.iter().any(moving);
    for contact in &report.contacts {
        // Walls that move give what they like.
        let judged = !driven || contact.solids.iter().all(|name| name != WALLS);
        if judged && contact.normal > CREATED * contact.largest_force * contact.largest_penetration {
            let who = parties(&contact.solids);
            let what = match has_stiffness(contact) {
                true => "say a `stiffness` or a shorter step",
                false => "take a shorter step",
            };
            all.push(format!(
                "contact of {who} gave them {:.2e} J instead of taking some: {what}",
                contact.normal
            ));
        }
    }
    all.extend(report.contacts.iter().filter_map(|contact| deep(scene, contact)));
    all.extend(beside_cracks(scene, report));
    all.extend(rubble(scene, report));
    if let Some(energy) = &report.energy {
        if energy.relative_residual > RESIDUAL {
            let percent = 100.0 * energy.relative_residual;
            all.push(format!(
                "the energy ledger leaves {percent:.0} % unexplained: the time step is too long, or the scene asks for \
                 what cannot be, as a body between walls that close or joints that contradict each other"
            ));
        }
        for participant in &energy.participants {
            let fracture = energy.joules(&participant.name, EnergyPart::Fracture);
            if let Some(given) = fracture.filter(|given| *given > 0.0) {
                all.push(format!(
                    "cracks of the {} gave it {given:.2e} J instead of taking some",
                    participant.name
                ));
            }
        }
    }
    all
}

/// What fracture took beyond the energy of the area that was opened: of solids with a probe for either.
fn beside_cracks(scene: &Scene, report: &RunReport) -> Vec<String> {
    let mut all = Vec::new();
    for (k, solid) in scene.solids.iter().enumerate() {
        let Some(keys) = solid.fracture() else { continue };
        let end = |is: fn(&ProbeKind) -> bool| {
            let probe = scene.probes.iter().find(|probe| is(&probe.kind) && probe.solid.unwrap_or(0) == k)?;
            let column =
                |column: &&ProbeReport| column.name.split_once('.').is_some_and(|c| c.0 == probe.name);
            report.probes.iter().find(column)?.end
        };
        let energy = end(|kind| matches!(kind, ProbeKind::CrackEnergy));
        let area = end(|kind| matches!(kind, ProbeKind::CrackArea));
        let Some((taken, area)) = energy.zip(area) else { continue };
        let side = scene.smallest_side([k; 2]);
        if area == 0.0 && taken > WITHOUT_CUT * keys.energy * side {
            all.push(format!(
                "fracture of the {} took {taken:.3} J, {:.1} times what a crack through its smallest side, {side:.3}, \
                 takes at {} J/m², and has cut nothing: what is damaged still carries (several cracks have begun, and \
                 none has gone through)",
                solid.name,
                taken / (keys.energy * side),
                keys.energy
            ));
        }
        if area == 0.0 {
            continue;
        }
        let times = taken / (keys.energy * area);
        if times > BESIDE_CRACKS {
            all.push(format!(
                "fracture of the {} took {taken:.3} J, {times:.1} times what the cracks of {area:.3} take at \
                 {} J/m². Cracks that have not gone through, crushed particles, or last rows that hold as hinges \
                 (off the lattice, or where a crack runs along its diagonals) took the rest: `damage` in the frames \
                 shows where",
                solid.name, keys.energy
            ));
        }
    }
    all
}

/// Solids that fell to single particles and rows, of those with a probe for it: more than one for two bodies.
fn rubble(scene: &Scene, report: &RunReport) -> Vec<String> {
    let mut all = Vec::new();
    for probe in scene.probes.iter().filter(|probe| matches!(probe.kind, ProbeKind::Bodies)) {
        let end = |column: &str| {
            let name = format!("{}.{column}", probe.name);
            report.probes.iter().find(|probe| probe.name == name)?.end
        };
        let Some((bodies, loose)) = end("bodies").zip(end("loose")) else { continue };
        if loose >= RUBBLE && loose > 0.5 * bodies {
            all.push(format!(
                "{loose} particles of the {} are debris of one particle or one row, and it has {bodies} bodies: how \
                 many, and where they go, depends on the spacing",
                scene.solids[probe.solid.unwrap_or(0)].name
            ));
        }
    }
    all
}

/// Solids that went far into each other, or into a wall.
fn deep(scene: &Scene, contact: &ContactReport) -> Option<String> {
    let index = |name: &String| scene.solids.iter().position(|solid| solid.name == *name);
    let of: Vec<usize> = contact.solids.iter().filter_map(index).collect();
    let smallest = scene.smallest_side([*of.first()?, *of.last()?]);
    (contact.largest_penetration > DEEP * smallest).then(|| {
        let what = match has_stiffness(contact) {
            true => "a larger `stiffness`, with shorter steps, holds it",
            false => "its stiffness follows from the speed that the scene expects: walls and bodies of one solid have \
                      no key for it, two solids have `[[contact]]`",
        };
        format!(
            "{} went {:.2e} m into each other, and their smallest side is {smallest:.2e} m: contact is too soft for \
             what met there ({what})",
            parties(&contact.solids),
            contact.largest_penetration
        )
    })
}

/// The scene can say the stiffness: of two solids.
fn has_stiffness(contact: &ContactReport) -> bool {
    matches!(&contact.solids[..], [a, b] if a != b && b != WALLS)
}

/// Two solids that touch, walls as one, or the bodies of one.
fn parties(names: &[String]) -> String {
    match names {
        [a, b] if a == b => format!("the bodies of {a}"),
        _ => names.join(" and "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_output::run_json::{Audit, ParticipantReport};
    use std::path::Path;

    #[test]
    fn how_a_run_ended() {
        let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
                    phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let of = |density_error, min_gap, tension, outside| {
            let (density_error, min_gap, tension) = (Some(density_error), Some(min_gap), Some(tension));
            let audit = Audit { density_error, min_gap, tension, ..Audit::default() };
            let solid =
                ParticipantReport { name: "flap".into(), particles: 40, outside, ..Default::default() };
            outcome(&scene, &RunReport { audit, participants: vec![solid], ..RunReport::default() })
        };
        assert_eq!(of(0.03, 0.1, 0.04, 0), [""; 0], "at their limits");
        let density = "density error up to 4 %: the fluid was compressed or torn somewhere";
        assert_eq!(of(0.04, 0.1, 0.0, 0), [density]);
        assert_eq!(of(0.0, 0.004, 0.0, 0), ["fluid and solid came as close as 0.004 dx"]);
        assert_eq!(
            of(0.0, 1.0, 0.095, 0),
            ["9.5 % of the fluid is under tension at the end: it would rather part"]
        );
        assert_eq!(of(0.0, 1.0, 0.0, 3), ["3 of 40 particles of the flap left the domain"]);
        let torn = ParticipantReport {
            name: "flap".into(),
            open_joints: vec![("pin".into(), 0.15)],
            ..Default::default()
        };
        let told = outcome(&scene, &RunReport { participants: vec![torn], ..RunReport::default() });
        assert!(
            told.len() == 1 && told[0].starts_with("the joint `pin` of the flap is 0.150 m open at the end")
        );
        let jerked = ParticipantReport {
            name: "flap".into(),
            jerked_joints: vec![("pin".into(), [0.12, 0.0])],
            ..Default::default()
        };
        let told = outcome(&scene, &RunReport { participants: vec![jerked], ..RunReport::default() });
        let begins =
            "the ends of the joint `pin` of the flap begin with velocities that differ by 1.20e-1 m/s";
        assert!(told.len() == 1 && told[0].starts_with(begins), "{told:?}");
    }

    #[test]
    fn solids_that_went_far_into_each_other_are_named() {
        let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n[[solid]]\nname = \"a\"\n\
                    model = \"rigid\"\ndensity = 500.0\n[[solid]]\nname = \"b\"\nmodel = \"rigid\"\n\
                    density = 500.0\n[[shape]]\nname = \"x\"\nphase = \"solid\"\nsolid = \"a\"\n\
                    box = { min = [0.0, 0.2], max = [0.1, 0.25] }\n[[shape]]\nname = \"y\"\nphase = \"solid\"\n\
                    solid = \"b\"\nbox = { min = [0.0, 0.4], max = [0.1, 0.5] }\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let of = |solids: [&str; 2], largest_penetration| {
            let solids = solids.map(String::from).to_vec();
            deep(&scene, &ContactReport { solids, largest_penetration, ..ContactReport::default() })
        };
        assert_eq!(of(["a", "b"], 0.0049), None, "a tenth of 50 mm");
        let said = of(["a", "b"], 0.0051).unwrap_or_default();
        assert!(
            said.starts_with("a and b went 5.10e-3 m into each other, and their smallest side is 5.00e-2 m")
        );
        assert_eq!(of(["b", WALLS], 0.0099), None, "of the block alone: 100 mm");
        let told = of(["b", WALLS], 0.0101).unwrap_or_default();
        assert!(said.contains("larger `stiffness`") && told.contains("have no key for it"), "{said} {told}");
    }

    #[test]
    fn debris_of_single_particles_is_told() {
        let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n[solid]\ndensity = 2000.0\n\
                    youngs_modulus = 1e9\npoissons_ratio = 0.2\nfracture = { strength = 1e5, energy = 2.0 }\n\
                    [[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.3] }\n\
                    [[probe]]\nname = \"pieces\"\nkind = \"bodies\"\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let of = |bodies, loose| {
            let column = |name: &str, end| ProbeReport { name: name.into(), end, ..Default::default() };
            let probes = vec![column("pieces.bodies", Some(bodies)), column("pieces.loose", Some(loose))];
            rubble(&scene, &RunReport { probes, ..RunReport::default() })
        };
        assert_eq!(of(12.0, 9.0), [""; 0], "few");
        assert_eq!(of(20.0, 10.0), [""; 0], "half of them");
        let said = "10 particles of the solid are debris of one particle or one row, and it has 19 bodies: how many, \
                    and where they go, depends on the spacing";
        assert_eq!(of(19.0, 10.0), [said]);
    }

    #[test]
    fn what_fracture_takes_beside_cracks_is_told() {
        let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n[solid]\ndensity = 2000.0\n\
                    youngs_modulus = 1e9\npoissons_ratio = 0.2\nfracture = { strength = 1e5, energy = 2.0 }\n\
                    [[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.3] }\n\
                    [[probe]]\nname = \"taken\"\nkind = \"crack-energy\"\n[[probe]]\nname = \"open\"\n\
                    kind = \"crack-area\"\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let column =
            |name: &str, end| ProbeReport { name: name.into(), end: Some(end), ..Default::default() };
        let of = |taken, area| {
            let probes = vec![column("taken.energy", taken), column("open.area", area)];
            beside_cracks(&scene, &RunReport { probes, ..RunReport::default() })
        };
        assert_eq!(of(1.19, 0.2), [""; 0], "2.98 times");
        assert_eq!(of(0.19, 0.0), [""; 0], "it is damaged");
        let without = of(0.3, 0.0);
        assert!(
            without.len() == 1
                && without[0].contains("1.5 times what a crack through its smallest side, 0.100")
        );
        let said = "fracture of the solid took 1.400 J, 3.5 times what the cracks of 0.200 take at 2 J/m². Cracks \
                    that have not gone through, crushed particles, or last rows that hold as hinges (off the lattice, \
                    or where a crack runs along its diagonals) took the rest: `damage` in the frames shows where";
        assert_eq!(of(1.4, 0.2), [said]);
    }
}

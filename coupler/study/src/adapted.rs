//! One scene for models that know different keys: what a model does not know is taken out, and told.

use halfstep_scene::{FluidIntegration, Scene, SceneErrors, SolidModelName};
use std::path::Path;

/// Most rounds of taking out: each finds what the ones before it have uncovered.
const ROUNDS: usize = 32;

/// What a model needs instead of a scene as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Adapted {
    /// Overrides that make the model read the scene.
    pub(super) overrides: Vec<String>,
    /// Keys that were taken out, as `--set` has them.
    pub(super) without: Vec<String>,
    /// Shapes that are fixed where they were clamped.
    pub(super) fixed: Vec<String>,
}

impl Adapted {
    /// Its name: of a probe that was taken out, whose curve the model does not have.
    pub(super) fn lacks_probe(&self, component: &str) -> bool {
        let name = component.split('.').next().unwrap_or_default();
        self.without.iter().any(|key| key.strip_prefix("probe.") == Some(name))
    }

    /// In words; empty where the scene is as it was.
    pub(super) fn text(&self) -> String {
        let quoted = |names: &[String]| names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
        match (self.without.is_empty(), self.fixed.is_empty()) {
            (true, _) => String::new(),
            (false, true) => format!("without {}, which it does not know", quoted(&self.without)),
            (false, false) => format!(
                "without {}, which it does not know; {} fixed where it was clamped",
                quoted(&self.without),
                quoted(&self.fixed)
            ),
        }
    }
}

/// Of a valid scene with overrides, for its solid of that index, `solid` or `solid.NAME`, with another model.
///
/// # Errors
/// What stands in the way of the model and is none of its keys.
pub(super) fn adapted(
    scene: &Scene,
    path: &Path,
    base: &[String],
    (index, key, model): (usize, &str, &str),
) -> Result<Adapted, SceneErrors> {
    let mut made = Adapted { overrides: base.to_vec(), ..Adapted::default() };
    made.overrides.push(format!("{key}.model={model}"));
    // What does not strain would let the water go by another rule: then that would be compared, too.
    if scene.fluid.as_ref().is_some_and(|fluid| fluid.time_integration == FluidIntegration::Midpoint) {
        made.overrides.push("fluid.time_integration=midpoint".into());
    }
    let mut first = None;
    for _ in 0..ROUNDS {
        let errors = match halfstep_scene::load(path, &made.overrides) {
            Ok(_) => return Ok(made),
            Err(errors) => errors,
        };
        let mut out: Vec<String> = Vec::new();
        for problem in &errors.problems {
            match foreign(&problem.key, key) {
                // Items by number: those after one that is taken out have another number then.
                Some(of)
                    if of.starts_with("reference.") && out.iter().any(|k| k.starts_with("reference.")) => {}
                Some(of) if !out.contains(&of) => out.push(of),
                Some(_) => {}
                None => return Err(first.unwrap_or(errors)),
            }
        }
        if out.iter().any(|key| !key.starts_with("reference.") && made.without.contains(key)) {
            return Err(first.unwrap_or(errors));
        }
        first.get_or_insert(errors);
        let clamped = out.iter().any(|key| key.ends_with(".clamp"));
        made.overrides.extend(out.iter().map(|key| format!("{key}=")));
        made.without.extend(out);
        if clamped && model == rigid() && made.fixed.is_empty() {
            made.fix(scene, index, key);
        }
    }
    Err(first.unwrap_or_else(|| unreachable!("a scene without an error has been returned")))
}

fn rigid() -> &'static str {
    SolidModelName::Rigid.name()
}

impl Adapted {
    /// What does not strain is fixed where it was clamped: to space, or to the wall that takes a clamp along.
    fn fix(&mut self, scene: &Scene, index: usize, key: &str) {
        let mut bodies: Vec<&str> = Vec::new();
        let mut joints = Vec::new();
        for shape in scene.shapes.iter().filter(|shape| shape.solid == Some(index) && !shape.clamp.is_empty())
        {
            if bodies.contains(&shape.body()) {
                continue;
            }
            bodies.push(shape.body());
            self.fixed.push(shape.name.clone());
            let with = shape.clamp_with.iter().flatten().next();
            let with = with.map_or(String::new(), |wall| format!(", with = \"{wall}\""));
            joints.push(format!(
                "{{ name = \"clamp-{}\", kind = \"fixed\", body = \"{}\"{with} }}",
                shape.name,
                shape.body()
            ));
        }
        self.overrides.push(format!("{key}.joints=[{}]", joints.join(", ")));
    }
}

/// The key to take out for a problem with this one, where it is one that only some models know.
fn foreign(problem: &str, solid: &str) -> Option<String> {
    let parts: Vec<&str> = problem.split('.').collect();
    if let Some(of_solid) = problem.strip_prefix(solid).and_then(|rest| rest.strip_prefix('.')) {
        const COMMON: [&str; 6] = ["name", "process", "threads", "model", "density", "sub_steps"];
        let own = of_solid.split('.').next()?;
        return (!COMMON.contains(&own)).then(|| format!("{solid}.{own}"));
    }
    match parts.as_slice() {
        ["shape", shape, key @ ("clamp" | "cantilever_mode" | "load" | "crack" | "density"), ..] => {
            Some(format!("shape.{shape}.{key}"))
        }
        ["probe" | "metric" | "reference", name, ..] => Some(format!("{}.{name}", parts[0])),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GATE: &str = "resolution = 0.01\nend_time = 1.0\n[solid]\ndensity = 1100.0\nyoungs_modulus = 1e7\n\
        poissons_ratio = 0.3\nprony = [[0.5, 0.01]]\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
        box = { min = [0.0, 0.0], max = [0.03, 0.2] }\nclamp = { min = [0.0, 0.15], max = [0.03, 0.2] }\n\
        [[probe]]\nname = \"tip\"\nkind = \"displacement\"\nat = [0.015, 0.0]\n[[probe]]\nname = \"stored\"\n\
        kind = \"strain-energy\"\n[[reference]]\nprobe = \"stored.energy\"\nlabel = \"none\"\npoints = [[0.0, 0.0]]\n";

    fn of(text: &str, base: &[&str], model: &str) -> Result<(Adapted, Scene), SceneErrors> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gate.toml");
        std::fs::write(&path, text).unwrap();
        let base: Vec<String> = base.iter().map(|o| o.to_string()).collect();
        let scene = halfstep_scene::load(&path, &base)?;
        let made = adapted(&scene, &path, &base, (0, "solid", model))?;
        let scene = halfstep_scene::load(&path, &made.overrides)?;
        Ok((made, scene))
    }

    /// Alone a rigid plate would let it go by position Verlet.
    #[test]
    fn the_water_keeps_its_rule_of_time_integration() {
        let water = "[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\nphase = \"fluid\"\n\
            box = { min = [0.1, 0.0], max = [0.2, 0.1] }\n";
        let text = format!("{GATE}{water}");
        for model in ["rigid", "hypoelastic"] {
            let (_, scene) = of(&text, &[], model).unwrap();
            assert_eq!(scene.numerics.cfl, 0.4, "{model}");
            assert_eq!(scene.fluid.unwrap().time_integration, FluidIntegration::Midpoint, "{model}");
        }
    }

    #[test]
    fn a_plate_becomes_rigid_and_is_fixed() {
        let (made, scene) = of(GATE, &[], "rigid").unwrap();
        let rigid = scene.solids[0].rigid().expect("rigid");
        assert_eq!((rigid.joints.len(), rigid.joints[0].body.as_str()), (1, "plate"));
        assert_eq!(made.fixed, ["plate"]);
        let mut without = made.without.clone();
        without.sort();
        let known =
            ["probe.stored", "reference.0", "shape.plate.clamp", "solid.poissons_ratio", "solid.prony"];
        assert_eq!(without, [&known[..], &["solid.youngs_modulus"]].concat());
        assert!(made.lacks_probe("stored.energy") && !made.lacks_probe("tip.x"));
        assert!(made.text().contains("`plate` fixed where it was clamped"), "{}", made.text());
    }

    #[test]
    fn a_model_that_knows_all_is_left_alone_and_a_missing_key_is_told() {
        let (made, _) = of(GATE, &[], "total-lagrangian").unwrap();
        assert_eq!((made.text().as_str(), made.overrides.len()), ("", 1));
        let (made, _) = of(GATE, &[], "hypoelastic").unwrap();
        assert_eq!(made.without, ["solid.prony"]);
        let rigid = GATE.replace(
            "youngs_modulus = 1e7\npoissons_ratio = 0.3\nprony = [[0.5, 0.01]]",
            "model = \"rigid\"",
        );
        let rigid = rigid.replace("clamp = { min = [0.0, 0.15], max = [0.03, 0.2] }\n", "").replace(
            "[[probe]]\nname = \"stored\"\nkind = \"strain-energy\"\n[[reference]]\nprobe = \"stored.energy\"\nlabel = \"none\"\npoints = [[0.0, 0.0]]\n",
            "",
        );
        let errors = of(&rigid, &[], "hypoelastic").unwrap_err();
        assert!(errors.problems.iter().any(|p| p.key == "solid.youngs_modulus"), "{errors:?}");
    }
}

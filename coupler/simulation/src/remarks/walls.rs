//! Remarks on walls: how thick they are where the fluid can come, and which way their surface goes.

use super::near;
use super::reached::{Matter, Places, is_driven, reached};
use halfstep_scene::geometry::{self, Cells, Layout, Regions, cell};
use halfstep_scene::{Phase, Scene};

/// Part of a wall's velocity across its face from which on it is no belt's.
const ACROSS: f64 = 0.5;

/// Walls with a velocity across a face that the fluid touches: the surface pushes and does not move.
pub(super) fn across<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let reach = 1.1 * scene.resolution;
    for (index, shape) in scene.shapes.iter().enumerate() {
        let speed = shape.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        if shape.phase != Phase::Wall || speed == 0.0 {
            continue;
        }
        let across = |p: &geometry::WallPoint<D>| {
            (0..D).map(|a| shape.velocity[a] * p.normal[a]).sum::<f64>().abs() > ACROSS * speed
        };
        let mut faces = Cells::new(reach);
        let own = layout.wall.iter().filter(|p| p.shape as usize == index && p.has_one_face());
        own.filter(|p| across(p)).for_each(|p| faces.add(&p.position, p.position));
        let wet = layout
            .fluid
            .iter()
            .find_map(|f| faces.around(&f.position).find(|x| near(x, &f.position, reach)).copied());
        if let Some(at) = wet {
            let at: Vec<String> = at.iter().map(|x| (*x as f32).to_string()).collect();
            all.push(format!(
                "`{}` has a velocity of {} m/s across its face at [{}]: a wall's `velocity` is that of a belt, whose \
                 surface stays where it is, and fluid that is pushed there goes nowhere (`motion` moves a wall)",
                shape.name,
                speed as f32,
                at.join(", ")
            ));
        }
    }
}

/// A place where a wall is thinner than the kernel's support.
struct Thin<const D: usize> {
    shape: usize,
    at: [f64; D],
    thickness: f64,
    /// Free places before it, where fluid would stand.
    before: [Option<[i64; D]>; 2],
}

impl<const D: usize> Thin<D> {
    fn is_wet(&self, reached: &Places<D>) -> bool {
        self.before.iter().flatten().any(|place| reached.contains(place))
    }
}

/// Where walls are thinner than the kernel's support, from either side: a single row has one normal and two faces.
fn thin_places<const D: usize>(scene: &Scene, layout: &Layout<D>, walls: &Matter<D>) -> Vec<Thin<D>> {
    let dx = scene.resolution;
    let support = kernel_support(scene);
    // Where rows of two walls meet at an angle they leave places free inside of them.
    let regions = Regions::of(scene, |shape| shape.phase == Phase::Wall);
    let inside = |x: &[f64; D]| regions.hold(x, -1e-6 * dx);
    let fill = |x: &[f64; D]| walls.fill(x) || inside(x);
    let mut all = Vec::new();
    for p in layout.wall.iter().filter(|p| p.has_one_face()) {
        for side in [1.0, -1.0] {
            let behind = |way: f64| -> [f64; D] {
                std::array::from_fn(|a| p.position[a] - side * way * dx * p.normal[a])
            };
            // Fluid next to it stands a spacing before it, or a little more where its cell begins.
            let places = [-1.0, -1.5].map(behind);
            let before = places.map(|x| (!fill(&x)).then(|| cell(&x, dx)));
            // A row that goes on inside of another wall has no surface there.
            if before == [None; 2] || inside(&places[0]) {
                continue;
            }
            // Half a spacing lies before the particle, and half a one behind the last place that is filled.
            let steps = (0..).map(|k| 0.5 * f64::from(k));
            let filled = steps.take_while(|k| k * dx < support && fill(&behind(*k)));
            let thickness = filled.count() as f64 * 0.5 * dx;
            if thickness < support - 0.51 * dx {
                all.push(Thin { shape: p.shape as usize, at: p.position, thickness, before });
            }
        }
    }
    all
}

pub(super) fn kernel_support(scene: &Scene) -> f64 {
    2.0 * scene.smoothing_ratio * scene.resolution
}

/// Walls that are thinner than the kernel's support where the fluid can come.
pub(super) fn thin<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    if layout.fluid.is_empty() || layout.wall.is_empty() {
        return;
    }
    let walls = Matter::of_walls(scene, layout);
    let places = thin_places(scene, layout, &walls);
    if places.is_empty() {
        return;
    }
    let level = reached(scene, layout, &walls, false);
    let still = thinnest(scene, &places, &level);
    let dry = |place: &Thin<D>| still[place.shape].is_none();
    let above = match places.iter().any(dry) && is_driven(scene, layout, &level) {
        true => thinnest(scene, &places, &reached(scene, layout, &walls, true)),
        false => vec![None; scene.shapes.len()],
    };
    let dx = scene.resolution;
    for (index, shape) in scene.shapes.iter().enumerate() {
        let what = match (still[index], above[index]) {
            (Some(_), _) => "fluid there is held weakly, and meets fluid behind it",
            (None, Some(_)) => {
                "no fluid is there at the start, and what moves the fluid may take it there: the wall holds it weakly"
            }
            _ => continue,
        };
        let Some((thickness, at)) = still[index].or(above[index]) else { continue };
        let at: Vec<String> = at.iter().map(|x| (*x as f32).to_string()).collect();
        all.push(format!(
            "`{}` is about {:.1} dx thick at [{}], and the fluid's kernel reaches {:.1} dx: {what}",
            shape.name,
            thickness / dx,
            at.join(", "),
            kernel_support(scene) / dx
        ));
    }
}

/// Where each shape is thinnest among the places that fluid reaches, m, by the shapes' indices.
fn thinnest<const D: usize>(
    scene: &Scene,
    places: &[Thin<D>],
    reached: &Places<D>,
) -> Vec<Option<(f64, [f64; D])>> {
    let mut all: Vec<Option<(f64, [f64; D])>> = vec![None; scene.shapes.len()];
    for place in places.iter().filter(|place| place.is_wet(reached)) {
        let least = &mut all[place.shape];
        if least.is_none_or(|(least, _)| place.thickness < least) {
            *least = Some((place.thickness, place.at));
        }
    }
    all
}

//! Rigid walls toward a solid that strains: exact surfaces, from which each particle is pushed by its depth, and what
//! approaches is damped as soon as it touches:
//!   F_i = [k delta_i + c w(delta_i) max(d delta_i / dt, 0)] n_i,   k = (K + 4 G / 3) / 2 dx^(D-2),
//!   c = 2 zeta sqrt(k m_s), w = 0 at the surface, 1 from a quarter of the distance d on, a straight line between,
//! for each side of the walls ([`WallSurface`]) by itself. delta_i is by how much the particle is closer than
//! d = dx / 2. What begins closer is pushed from where it is, and once it has left that side, from the surface on.
//!
//! Kayaki's section 4.1 extrapolates the solid's pressure to its walls, after Adami. Here a wall has none: such a push
//! follows from no energy, begins 2h off the wall and pushes a body up that lies on it.

use crate::columns::Vectors;
use halfstep_scene::geometry::WallSurface;
use halfstep_scene::{Placement, Scene};
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::state::{Fields, StateError};
use std::ops::Range;

/// zeta. A disc of rubber, 20 particles across, loses 0.6 % of its energy by it.
const DAMPING_RATIO: f64 = 0.2;
/// Depth from which on the whole damping acts, over d.
const TOUCH: f64 = 0.25;
/// Distance below a surface from which on what is there is not of this side of the wall, in spacings of the solid.
const DEEP: f64 = 2.0;

/// Particle, wall, part of the wall and face of the part.
type Key = [u32; 4];

/// Walls that the solid may touch.
pub(crate) struct Walls<const D: usize> {
    walls: Vec<Wall>,
    /// Now, s.
    time: f64,
    /// When the lists were made, s.
    listed_at: f64,
    /// d, m.
    distance: f64,
    /// Distance that lists hold beyond what touches, m.
    skin: f64,
    near: Vec<Near>,
    edges: Vec<u32>,
    /// Of the state that was evaluated last, by slot.
    touches: Vec<Touch<D>>,
    /// Acceleration of the solid's slots, m/s².
    push: Vec<[f64; D]>,
    /// How deep particles begin, m, ascending by key.
    rest: Vec<(Key, f64)>,
}

/// Walls that move alike.
struct Wall {
    surface: WallSurface,
    now: Placement,
    /// When the lists were made.
    listed: Placement,
}

/// A particle that may touch a part of a wall.
struct Near {
    slot: u32,
    wall: u32,
    part: u32,
    edges: Range<usize>,
}

/// A particle closer than d to a wall.
struct Touch<const D: usize> {
    slot: u32,
    key: Key,
    /// delta, m, from the surface on.
    depth: f64,
    /// n, out of the wall.
    normal: [f64; D],
    /// Acceleration along n, m/s².
    push: f64,
    /// Velocity of the wall there, m/s.
    carried: [f64; D],
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}

impl Wall {
    fn at(&self, time: f64) -> Placement {
        self.surface.motion.as_ref().map_or_else(Placement::default, |motion| motion.at(time))
    }
}

impl<const D: usize> Walls<D> {
    /// `None` where the scene's solid of that index may touch none of the walls. Lists hold `skin`, m, more than
    /// needed.
    pub(crate) fn new(scene: &Scene, solid: usize, skin: f64) -> Option<Self> {
        let wall = |surface: WallSurface| {
            let mut wall = Wall { surface, now: Placement::default(), listed: Placement::default() };
            wall.now = wall.at(0.0);
            wall
        };
        let walls: Vec<Wall> = WallSurface::all(scene).into_iter().map(wall).collect();
        (!walls.is_empty()).then(|| Self {
            walls,
            time: 0.0,
            listed_at: 0.0,
            distance: 0.5 * scene.solid_spacing(solid),
            skin,
            near: Vec::new(),
            edges: Vec::new(),
            touches: Vec::new(),
            push: Vec::new(),
            rest: Vec::new(),
        })
    }

    /// Brings the walls that move to where they are at a time, s.
    pub(crate) fn set_time(&mut self, time: f64) {
        self.time = time;
        for wall in &mut self.walls {
            wall.now = wall.at(time);
        }
    }

    /// Largest displacement since the lists were made, m.
    pub(crate) fn displacement(&self) -> f64 {
        let of = |wall: &Wall| wall.now.moved_since(&wall.listed, wall.surface.radius);
        self.walls.iter().map(of).fold(0.0, f64::max)
    }

    /// Brings the walls that move to where they were when the lists were made.
    pub(crate) fn return_to_lists(&mut self) {
        self.set_time(self.listed_at);
    }

    /// Lists who is near whom.
    pub(crate) fn relist(&mut self, id: &[u32], solid: &Vectors<D>) {
        self.listed_at = self.time;
        (self.near, self.edges, self.touches) = (Vec::new(), Vec::new(), Vec::new());
        self.push = vec![[0.0; D]; id.len()];
        for wall in &mut self.walls {
            wall.listed = wall.now;
        }
        let reach = 2.0 * DEEP * self.distance + self.skin;
        for slot in (0..id.len()).filter(|&slot| id[slot] != PADDING) {
            let at = std::array::from_fn(|d| solid[d][slot]);
            for (k, wall) in self.walls.iter().enumerate() {
                let at = wall.now.point_at(at);
                for part in 0..wall.surface.parts() {
                    let first = self.edges.len();
                    let mut touches = false;
                    if wall.surface.near(part, at, [reach, self.skin], &mut self.edges) {
                        wall.surface.nearest(
                            part,
                            &self.edges[first..],
                            at,
                            &mut |_, distance, _: [f64; D]| {
                                touches |= distance < self.distance + self.skin;
                            },
                        );
                    }
                    match touches {
                        true => self.near.push(Near {
                            slot: slot as u32,
                            wall: k as u32,
                            part: part as u32,
                            edges: first..self.edges.len(),
                        }),
                        false => self.edges.truncate(first),
                    }
                }
            }
        }
    }

    /// Pairs of a particle and a part of a wall that are evaluated.
    pub(crate) fn pairs(&self) -> usize {
        self.near.len()
    }

    /// The solid begins where it is: nothing pushes.
    pub(crate) fn begin(&mut self, solid: Touching<'_, D>) {
        self.rest.clear();
        self.act(solid);
        self.rest = self.touches.iter().map(|touch| (touch.key, touch.depth)).collect();
        self.rest.sort_unstable_by_key(|(key, _)| *key);
        self.act(solid);
    }

    /// Evaluates the push on every solid particle.
    pub(crate) fn act(&mut self, solid: Touching<'_, D>) {
        self.touches.clear();
        self.push.fill([0.0; D]);
        let deepest = (1.0 + 2.0 * DEEP) * self.distance;
        for near in &self.near {
            let (slot, wall) = (near.slot as usize, &self.walls[near.wall as usize]);
            let [at, velocity]: [[f64; D]; 2] =
                [solid.position, solid.velocity].map(|column| std::array::from_fn(|d| column[d][slot]));
            let below = wall.now.point_at(at);
            let edges = &self.edges[near.edges.clone()];
            wall.surface.nearest(
                near.part as usize,
                edges,
                below,
                &mut |face, distance, normal: [f64; D]| {
                    let depth = self.distance - distance;
                    if depth <= 0.0 || depth >= deepest {
                        return;
                    }
                    let key = [solid.id[slot], near.wall, near.part, face];
                    let rest = self.rest.binary_search_by_key(&key, |(key, _)| *key);
                    let pushing = depth - rest.map_or(0.0, |k| self.rest[k].1);
                    let (normal, carried) = (wall.now.direction_of(normal), wall.now.velocity_of(below));
                    let push = if pushing > 0.0 {
                        let approach = (dot(&normal, &carried) - dot(&normal, &velocity)).max(0.0);
                        let touch = (pushing / (TOUCH * self.distance)).min(1.0);
                        solid.repulsion * pushing + solid.dashpot() * touch * approach
                    } else {
                        0.0
                    };
                    for d in 0..D {
                        self.push[slot][d] += push * normal[d];
                    }
                    self.touches.push(Touch { slot: near.slot, key, depth, normal, push, carried });
                },
            );
        }
    }

    /// What has left a side in the state that was evaluated last touches its surface from now on.
    pub(crate) fn leave(&mut self) {
        if !self.rest.is_empty() {
            let mut touched: Vec<Key> = self.touches.iter().map(|touch| touch.key).collect();
            touched.sort_unstable();
            self.rest.retain(|(key, _)| touched.binary_search(key).is_ok());
        }
    }

    /// What pushes the solid particle at a slot.
    fn pushing(&self, slot: usize) -> impl Iterator<Item = &Touch<D>> + Clone {
        let first = self.touches.partition_point(|touch| (touch.slot as usize) < slot);
        let of = self.touches[first..].iter().take_while(move |touch| touch.slot as usize == slot);
        of.filter(|touch| touch.push > 0.0)
    }

    /// What walls add to the square of a particle's frequency, 1/s², and its damping, 1/s.
    pub(crate) fn stiffness(&self, solid: Touching<'_, D>, slot: usize) -> (f64, f64) {
        let all = self.pushing(slot);
        // No eigenvalue of sum n n^T is larger.
        let row =
            |one: &Touch<D>| all.clone().map(|other| dot(&one.normal, &other.normal).abs()).sum::<f64>();
        let largest = all.clone().map(row).fold(0.0, f64::max);
        (largest * solid.repulsion, largest * solid.dashpot())
    }

    /// Power of walls that move on the solid's particles, in the state that was evaluated last, over a particle's mass,
    /// W/kg. `id` are the numbers of the solid's slots, `free` is the part of a particle that no clamp holds.
    pub(crate) fn power(&self, id: &[u32], free: impl Fn(u32) -> f64) -> f64 {
        let of = |touch: &Touch<D>| {
            touch.push * dot(&touch.normal, &touch.carried) * free(id[touch.slot as usize])
        };
        self.touches.iter().filter(|touch| touch.push > 0.0).map(of).sum()
    }

    /// Calls `visit` with the slot of each particle that a wall pushes, the normal out of the wall, the acceleration
    /// along that, m/s², and the velocity of the wall's surface, m/s.
    pub(crate) fn touching(&self, mut visit: impl FnMut(usize, [f64; D], f64, [f64; D])) {
        for touch in self.touches.iter().filter(|touch| touch.push > 0.0) {
            let belt = &self.walls[touch.key[1] as usize].surface.belt;
            let velocity = std::array::from_fn(|d| touch.carried[d] + belt[d]);
            visit(touch.slot as usize, touch.normal, touch.push, velocity);
        }
    }

    /// Visits what walls keep over an interruption.
    pub(crate) fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.real("walls_listed_at", &mut self.listed_at)?;
        let mut keys: Vec<u32> = self.rest.iter().flat_map(|(key, _)| *key).collect();
        let mut depths: Vec<f64> = self.rest.iter().map(|(_, depth)| *depth).collect();
        fields.numbers("walls_touched", &mut keys)?;
        fields.reals("walls_rest", &mut depths)?;
        fields.length("walls_rest", keys.len() / 4, depths.len())?;
        if fields.loading() {
            let keys = keys.chunks_exact(4).map(|k| [k[0], k[1], k[2], k[3]]);
            self.rest = keys.zip(depths).collect();
        }
        Ok(())
    }

    /// Acceleration of the solid particle at a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; D] {
        self.push[slot]
    }
}

/// The solid as walls see it: columns sorted by the rows that the lists were made with.
#[derive(Clone, Copy)]
pub(crate) struct Touching<'a, const D: usize> {
    /// Particle number of a slot, or padding.
    pub(crate) id: &'a [u32],
    /// m.
    pub(crate) position: &'a Vectors<D>,
    /// m/s.
    pub(crate) velocity: &'a Vectors<D>,
    /// k over a particle's mass, 1/s²: see [`repulsion`].
    pub(crate) repulsion: f64,
}

impl<const D: usize> Touching<'_, D> {
    /// c over a particle's mass, 1/s.
    fn dashpot(&self) -> f64 {
        2.0 * DAMPING_RATIO * self.repulsion.sqrt()
    }
}

/// k over a particle's mass, 1/s², for a material's pressure waves and spacing.
pub(crate) fn repulsion(pressure_wave_speed: f64, spacing: f64) -> f64 {
    0.5 * (pressure_wave_speed / spacing).powi(2)
}

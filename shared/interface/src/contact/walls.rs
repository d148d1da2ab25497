//! Contact of a solid with the walls of a scene, from its records: of one that another program computes, or that
//! strains and has a friction and a restitution.
//!
//! Points of the solid's outline are held against the walls' exact surfaces ([`Surface`]), wherever these are by now,
//! and corners of the walls against the outline (`corners`).
//! The law is that between two solids ([`Law`]) with all of K on the points, since a wall has none of its own, and
//! 1/m_b = 0. A point that begins inside of a wall finds its surface where the point begins: what is let into a wall is
//! not thrown out of it.

use super::corners::Corners;
use super::flanks::share_at_first;
use super::law::{Law, dot, give, less};
use super::outline::Outline;
use super::placed::Placed;
use super::{Booked, Side};
use halfstep_scene::geometry::{self, Surface};
use halfstep_scene::{Motion, Placement, Scene, Shape};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::{Fields, State, StateError};

/// A wall that solids may touch.
#[derive(Clone, Debug)]
struct Wall {
    surface: Surface,
    motion: Option<Motion>,
    /// Velocity of its surface, which stays where it is, m/s.
    belt: [f64; 2],
}

/// A point inside of a wall.
#[derive(Clone, Copy, Debug)]
struct Near {
    /// Wall, point, and which of the wall's surfaces.
    key: [u32; 3],
    /// How far inside, m.
    depth: f64,
    /// Out of the wall.
    normal: [f64; 2],
}

/// A contact as it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Touch {
    key: [u32; 3],
    /// Where the point sticks: on the wall as the scene has it, m, where it was put there at `time`, s.
    place: [f64; 2],
    time: f64,
    /// Largest approach so far, m/s.
    approach: f64,
    /// How much of the push it takes.
    share_of_push: f64,
}

/// Contact of a solid with all walls of a scene.
#[derive(Clone, Debug)]
pub struct WallContact {
    scene: Scene,
    solid: usize,
    law: Law,
    walls: Vec<Wall>,
    outline: Outline,
    placed: Placed,
    corners: Corners,
    side: Side,
    /// How deep points begin in walls, by key, ascending.
    let_in: Vec<([u32; 3], f64)>,
    /// Contacts at n, ascending.
    touches: Vec<Touch>,
    /// Contacts at n + 1/2.
    halfway: Vec<Touch>,
    near: Vec<Near>,
    booked: Booked,
    /// Positions of the first state, m, and masses, kg (2D: kg/m).
    first: (Vec<[f64; 2]>, Vec<f64>),
}

impl WallContact {
    /// Of a scene's solid of that index; `None` where it can touch no wall, and in space.
    ///
    /// Friction and restitution are those of the solid's own `contact`, else zero.
    pub fn new(scene: &Scene, solid: usize) -> Option<Self> {
        if scene.dimension != 2 || scene.walls_to_touch().next().is_none() {
            return None;
        }
        let wall = |(_, shape): (usize, &Shape)| Wall {
            surface: Surface::new(&shape.geometry, None),
            motion: shape.motion.clone(),
            belt: [shape.velocity[0], shape.velocity[1]],
        };
        Some(Self {
            law: Law::of(&scene.own_contact(solid)),
            walls: scene.walls_to_touch().map(wall).collect(),
            outline: Outline::default(),
            placed: Placed::default(),
            corners: Corners::default(),
            side: Side { solid, ..Side::default() },
            let_in: Vec::new(),
            touches: Vec::new(),
            halfway: Vec::new(),
            near: Vec::new(),
            booked: Booked::default(),
            first: (Vec::new(), Vec::new()),
            scene: scene.clone(),
            solid,
        })
    }

    /// Takes the first state of a run.
    pub fn begin(&mut self, records: &[StateRecord]) {
        let at = |r: &StateRecord| [r.position[0], r.position[1]];
        self.first = (records.iter().map(at).collect(), records.iter().map(|r| r.mass).collect());
        self.build();
    }

    fn build(&mut self) {
        let (at, mass) = &self.first;
        self.outline = Outline::new(&self.scene, &geometry::solids(&self.scene), self.solid, at, mass);
        let masses = [self.outline.least_mass(), f64::INFINITY];
        self.law.fit(&self.scene, [self.solid; 2], masses);
        let record = |x: &[f64; 2]| StateRecord { position: [x[0], x[1], 0.0], ..StateRecord::default() };
        let records: Vec<StateRecord> = at.iter().map(record).collect();
        self.placed.bound(&self.outline, &records);
        self.placed.place(&self.outline, &records);
        self.find(&self.placements(0.0));
        self.let_in = self.near.iter().map(|near| (near.key, near.depth)).collect();
        self.let_in.sort_unstable_by_key(|(key, _)| *key);
        let touches = std::mem::take(&mut self.corners.touches);
        self.corners = Corners::new(&self.scene, (&self.outline, &self.placed));
        self.corners.touches = touches;
    }

    /// Whether there is a surface that can touch: particles lie where the scene has the solid.
    pub fn has_surface(&self) -> bool {
        !self.outline.pieces.is_empty()
    }

    /// The law.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Largest time step that contact is stable with, s.
    pub fn limit(&self) -> f64 {
        self.law.limit
    }

    /// What walls did so far.
    pub fn booked(&self) -> Booked {
        self.booked
    }

    /// Force on a record, N (2D: N/m).
    pub fn on(&self, record: usize) -> [f64; 2] {
        let of = |forces: &Vec<[f64; 2]>| forces.get(record).copied().unwrap_or_default();
        let [normal, along] = self.side.forces.each_ref().map(of);
        [normal[0] + along[0], normal[1] + along[1]]
    }

    /// Books the work of the present forces on the way of the records from the state at n before to this one, and
    /// returns it, J (2D: J/m).
    pub fn work(&mut self, way: impl Fn(usize) -> [f64; 2]) -> f64 {
        let done = self.side.work(&way);
        self.booked.normal += done[0];
        self.booked.friction += done[1];
        done[0] + done[1]
    }

    fn placements(&self, time: f64) -> Vec<Placement> {
        let of = |wall: &Wall| wall.motion.as_ref().map_or_else(Placement::default, |m| m.at(time));
        self.walls.iter().map(of).collect()
    }

    /// Finds the points inside of walls.
    fn find(&mut self, placements: &[Placement]) {
        self.near.clear();
        let whole = |p: &&u32| !self.placed.is_torn(**p);
        let points = || self.outline.pieces.iter().flat_map(|piece| &piece.points).filter(whole);
        for ((k, wall), placement) in self.walls.iter().enumerate().zip(placements) {
            for &point in points() {
                let at = placement.point_at(self.placed.position[point as usize]);
                let mut surface = 0;
                wall.surface.nearest(at, &mut |distance, normal: [f64; 2]| {
                    if distance < 0.0 {
                        let key = [k as u32, point, surface];
                        let normal = placement.direction_of(normal);
                        self.near.push(Near { key, depth: -distance, normal });
                    }
                    surface += 1;
                });
            }
        }
    }

    /// Evaluates contact with the walls at the records' instant, s, in a time step `dt`, s. `whole`: of a state at n,
    /// from which the contacts go on; else it is one at n + 1/2.
    pub fn evaluate(&mut self, records: &[StateRecord], [time, dt]: [f64; 2], whole: bool) {
        self.side.forces.iter_mut().for_each(Vec::clear);
        self.halfway.clear();
        let mut deepest = 0.0_f64;
        if self.has_surface() {
            self.placed.bound(&self.outline, records);
            self.placed.place(&self.outline, records);
            let placements = self.placements(time);
            self.find(&placements);
            for k in 0..self.near.len() {
                deepest = deepest.max(self.touch(self.near[k], &placements, [time, dt], records.len()));
            }
            self.halfway.sort_unstable_by_key(|touch| touch.key);
            let solid = (&self.outline, &self.placed);
            let on = (&mut self.side, records.len());
            deepest = deepest.max(self.corners.act(&self.law, &placements, solid, on, (dt, whole)));
        }
        if whole {
            std::mem::swap(&mut self.touches, &mut self.halfway);
        }
        self.booked.note(&self.side.forces, deepest);
    }

    /// Adds the force on a point inside of a wall; returns how deep it is in it, m.
    fn touch(&mut self, near: Near, placements: &[Placement], [time, dt]: [f64; 2], records: usize) -> f64 {
        let Near { key, depth, normal } = near;
        let let_in = self.let_in.binary_search_by_key(&key, |(key, _)| *key);
        let depth = depth - let_in.map_or(0.0, |k| self.let_in[k].1);
        if depth <= 0.0 {
            return 0.0;
        }
        let (wall, placement) = (&self.walls[key[0] as usize], &placements[key[0] as usize]);
        let at = self.placed.position[key[1] as usize];
        let below = placement.point_at(at);
        let carried = placement.velocity_of(below);
        let slip = less(self.placed.velocity[key[1] as usize], [0, 1].map(|d| carried[d] + wall.belt[d]));
        let tangent = [-normal[1], normal[0]];
        let approach = -dot(slip, normal);
        let before = self.touches.binary_search_by_key(&key, |touch| touch.key);
        let fresh = || {
            let solid = (&self.outline, &self.placed);
            let foot = [0, 1].map(|d| at[d] + near.depth * normal[d]);
            let beyond = self.corners.beyond(solid, (key[0] as usize, placement), [foot, normal]);
            let share_of_push = share_at_first(solid, key[1], normal, beyond);
            Touch { key, place: below, time, approach: 0.0, share_of_push }
        };
        let mut touch = before.map_or_else(|_| fresh(), |k| self.touches[k]);
        touch.approach = touch.approach.max(approach);
        let spring = self.law.stiffness * touch.share_of_push * self.outline.points[key[1] as usize].length;
        let push = self.law.push(spring, depth, [approach, touch.approach], dt);
        let stuck = placement.position_of(touch.place);
        let from = [0, 1].map(|d| at[d] - stuck[d] - wall.belt[d] * (time - touch.time));
        let (along, slipped) = self.law.along(spring, push, dot(from, tangent), dot(slip, tangent));
        if let Some(left) = slipped {
            touch.place = placement.point_at([0, 1].map(|d| at[d] - left * tangent[d]));
            touch.time = time;
        }
        self.halfway.push(touch);
        let forces = [normal.map(|n| push * n), tangent.map(|t| along * t)];
        for (on, force) in self.side.forces.iter_mut().zip(forces) {
            on.resize(records, [0.0; 2]);
            give(&self.outline, key[1], force, on);
        }
        if touch.share_of_push > 0.0 { depth } else { 0.0 }
    }
}

impl State for WallContact {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let (at, mass) = &mut self.first;
        fields.points("first", at)?;
        fields.reals("mass", mass)?;
        fields.length("mass", at.len(), mass.len())?;
        self.booked.fields(fields)?;
        let [normal, along] = &mut self.side.forces;
        fields.points("normal_force", normal)?;
        fields.points("along_force", along)?;
        fields.length("along_force", normal.len(), along.len())?;
        let touches = &mut self.touches;
        let mut numbers: Vec<u32> = touches.iter().flat_map(|t| t.key).collect();
        let real = |t: &Touch| [t.place[0], t.place[1], t.time, t.approach, t.share_of_push];
        let mut reals: Vec<f64> = touches.iter().flat_map(real).collect();
        fields.numbers("touches", &mut numbers)?;
        fields.reals("sticking", &mut reals)?;
        fields.length("sticking", numbers.len() / 3 * 5, reals.len())?;
        if fields.loading() {
            let of = |(n, r): (&[u32], &[f64])| Touch {
                key: [n[0], n[1], n[2]],
                place: [r[0], r[1]],
                time: r[2],
                approach: r[3],
                share_of_push: r[4],
            };
            *touches = numbers.chunks_exact(3).zip(reals.chunks_exact(5)).map(of).collect();
        }
        fields.part("corners", &mut self.corners)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.build();
        if !self.corners.know(&self.outline) {
            return Err(StateError::contradiction(
                "a contact of a wall's corner that the scene does not have",
            ));
        }
        let (forces, records) = (self.side.forces[0].len(), self.first.0.len());
        if forces != 0 && forces != records {
            return Err(StateError::contradiction("forces of walls on other records than the first ones"));
        }
        Ok(())
    }
}

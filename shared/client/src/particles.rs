//! The particles that the scene gives a solid: the file of the variable HALFSTEP_PARTICLES.

use crate::Error;

/// Columns of the file: position, velocity, mass, density, clamped, body, copy.
const COLUMNS: usize = 11;

/// Particles of a solid, in the order of their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// Where each is, m.
    pub position: Vec<[f64; 3]>,
    /// How fast, m/s.
    pub velocity: Vec<[f64; 3]>,
    /// Mass, kg (2D: kg/m).
    pub mass: Vec<f64>,
    /// Density, kg/m³.
    pub density: Vec<f64>,
    /// Held by a clamp of the scene.
    pub clamped: Vec<bool>,
    /// Number of the connected body, from 0 on; empty: nothing is said of bodies.
    pub body: Vec<u32>,
}

impl Particles {
    /// The particles that the scene has for this solid: its shapes on their lattice, clamped rows included.
    ///
    /// # Errors
    /// [`Error::Run`]: this program was not started by a run, or the file cannot be read.
    pub fn of_scene() -> Result<Self, Error> {
        let path = std::env::var("HALFSTEP_PARTICLES").map_err(|_| {
            let how =
                "start it with `halfstep run SCENE --solid COMMAND`, or alone with `halfstep fake-fluid`";
            Error::Run(format!("HALFSTEP_PARTICLES is not set: this program is the solid of a run, {how}"))
        })?;
        let text = std::fs::read_to_string(&path).map_err(|e| Error::Run(format!("{path}: {e}")))?;
        Self::parse(&text).ok_or_else(|| Error::Run(format!("{path}: no table of particles")))
    }

    fn parse(text: &str) -> Option<Self> {
        let mut all = Self::default();
        for row in csv::Reader::from_reader(text.as_bytes()).deserialize() {
            let row: Vec<f64> = row.ok()?;
            let &[x, y, z, u, v, w, mass, density, clamped, body, _] =
                row.as_slice().as_array::<COLUMNS>()?;
            all.position.push([x, y, z]);
            all.velocity.push([u, v, w]);
            all.mass.push(mass);
            all.density.push(density);
            all.clamped.push(clamped != 0.0);
            all.body.push(body as u32);
        }
        Some(all)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.mass.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_by_hand() {
        let titles = "a,b,c,d,e,f,g,h,i,j,k\n";
        let table = |rows: &str| Particles::parse(&format!("{titles}{rows}"));
        let found = table("1,2,3,4,5,6,7,8,1,0,2\n-1e-3,0,0,0,0,0,7,9,0,3,2\n").unwrap();
        let expected = Particles {
            position: vec![[1.0, 2.0, 3.0], [-1e-3, 0.0, 0.0]],
            velocity: vec![[4.0, 5.0, 6.0], [0.0; 3]],
            mass: vec![7.0; 2],
            density: vec![8.0, 9.0],
            clamped: vec![true, false],
            body: vec![0, 3],
        };
        assert_eq!(found, expected);
        assert!(table("1,2\n").is_none() && table("1,2,3,4,5,6,7,8,1,0,no\n").is_none());
        assert_eq!(Particles::parse("x\n1\n"), None);
    }
}

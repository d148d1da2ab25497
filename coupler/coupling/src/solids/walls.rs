//! Who evaluates contact with walls: of external solids the coupler, from their records, unless they do it themselves;
//! of others their models, unless these leave it to the coupler.

use super::Solids;
use crate::recorder::Recorder;
use halfstep_interface::contact::WallContact;
use halfstep_link::StateMessage;
use halfstep_wire::Name;

/// Who evaluates contact of a solid with the walls that the scene lets it touch.
pub(crate) enum Walls<'a> {
    /// The coupler.
    Coupler(&'a WallContact),
    /// The solid, as it says.
    Own,
    /// Nobody but the solid can: the coupler knows no contact in space.
    Space,
}

impl Walls<'_> {
    /// Says it of the solid of that name in the log; warns of a solid that touches nothing.
    pub(crate) fn say(&self, name: Name, recorder: &Recorder) {
        match self {
            Self::Coupler(walls) if !walls.has_surface() => recorder.warn(&format!(
                "walls do not stop the {name}: none of its particles lies where the scene has it"
            )),
            Self::Coupler(walls) => {
                let ([friction, restitution], stiffness) = (walls.law().said(), walls.law().stiffness);
                tracing::info!(
                    "contact of the {name} with walls: by the coupler, friction {friction}, restitution {restitution}, \
                     {stiffness:.3e} Pa/m"
                );
            }
            Self::Own => tracing::info!("contact of the {name} with walls: by itself, as it says"),
            Self::Space => {
                tracing::info!("contact of the {name} with walls: by itself; the coupler knows none in space")
            }
        }
    }
}

impl<const D: usize> Solids<D> {
    /// Leaves walls to the solids that say that they evaluate these themselves. Returns the place of one that says now
    /// what it did not say when the checkpoint was written, or the other way round.
    pub(crate) fn leave_walls(&mut self, states: &[impl StateMessage], resumed: bool) -> Option<usize> {
        let mut changed = None;
        for (place, state) in states.iter().enumerate().skip(self.first) {
            let side = &mut self.solids[place - self.first];
            let Some(external) = &mut side.external else { continue };
            let own = state.header().holds_own_walls();
            if resumed && own != external.own_walls {
                changed = changed.or(Some(place));
            }
            external.own_walls = own;
            if own {
                side.walls = None;
            }
        }
        changed
    }

    /// Who evaluates the walls of each solid that the scene lets touch some, with its place, where it is not a model of
    /// the program.
    pub(crate) fn walls(&self) -> impl Iterator<Item = (usize, Walls<'_>)> {
        self.solids.iter().enumerate().filter_map(|(solid, side)| {
            let walls = match (&side.walls, &side.external) {
                _ if !side.touches_walls => return None,
                (_, Some(external)) if external.own_walls => Walls::Own,
                (Some(walls), _) => Walls::Coupler(walls),
                (None, Some(_)) => Walls::Space,
                (None, None) => return None,
            };
            Some((self.first + solid, walls))
        })
    }
}

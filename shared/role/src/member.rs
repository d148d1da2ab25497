//! A participant of a process, with what it writes and where it begins.

use crate::published::Published;
use crate::role::Role;
use halfstep_wire::frame::FrameSink;
use halfstep_wire::state::{Group, State, StateError, StateSink};

/// A participant, where its frames and checkpoints go, and where it begins.
pub struct Member {
    /// Owner of the particles.
    pub role: Box<dyn Role>,
    /// Without one no frames are written.
    pub frames: Option<Box<dyn FrameSink>>,
    /// Without one no checkpoints are written.
    pub checkpoints: Option<Box<dyn StateSink>>,
    /// The state that it goes on from; `None`: the scene's first.
    pub resumed: Option<Published>,
}

impl Member {
    /// At the scene's first state, with nothing written.
    pub fn new(role: Box<dyn Role>) -> Self {
        Self { role, frames: None, checkpoints: None, resumed: None }
    }

    /// Goes on from a checkpoint.
    ///
    /// # Errors
    /// The checkpoint is not one of this participant in this scene.
    pub fn resume(&mut self, checkpoint: &Group) -> Result<(), StateError> {
        let mut published = Published::default();
        published.load(checkpoint)?;
        let own = || StateError::contradiction("this participant cannot be saved");
        let role = checkpoint.groups.get("role").ok_or(StateError::Missing { field: "role".into() })?;
        self.role.state().ok_or_else(own)?.load(role)?;
        self.resumed = Some(published);
        Ok(())
    }
}

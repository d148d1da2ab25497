//! Scenes that a test writes.

use crate::run::{RunBuilder, scene_at};
use std::path::PathBuf;

/// A scene's file, gone with its folder.
pub struct Written {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Written {
    /// Writes it.
    pub fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).expect("a scene");
        Self { _folder: folder, path }
    }

    /// A run of it.
    pub fn run(&self) -> RunBuilder {
        scene_at(&self.path)
    }

    /// A run with that model of its one solid.
    pub fn run_as(&self, model: &str) -> RunBuilder {
        self.run().set("solid.model", model)
    }
}

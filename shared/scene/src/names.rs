//! Spelling of names in resolved scenes whose types belong to the crate of the numerics, which knows no files.

use halfstep_sph::Phase;
use halfstep_sph::kernel::KernelName;
use halfstep_sph::lane::Precision;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
#[serde(remote = "Phase", rename_all = "kebab-case")]
pub(crate) enum PhaseName {
    Fluid,
    Solid,
    Wall,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "KernelName", rename_all = "kebab-case")]
pub(crate) enum Kernel {
    CubicSpline,
    WendlandC2,
}

/// Serialises [`Precision`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "Precision", rename_all = "kebab-case")]
pub(crate) enum PrecisionName {
    Double,
    Mixed,
}

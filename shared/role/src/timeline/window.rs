//! The steps whose half-steps are recorded.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

/// Steps from `from` on, up to `to`, which is no longer one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    from: u64,
    to: u64,
}

/// Why a text is no window of steps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadWindow {
    /// It does not look like one.
    #[error("`{0}` is not FROM..TO, two numbers of steps such as 100..120")]
    Form(String),
    /// It holds no step.
    #[error("{from}..{to} holds no step: the window ends before step TO, so TO must be greater than FROM")]
    Empty {
        /// First step.
        from: u64,
        /// The step after the last.
        to: u64,
    },
    /// It holds too many.
    #[error(
        "{from}..{to} holds {} steps, more than the {} of a timeline that can be looked at",
        to - from,
        Window::MOST_STEPS
    )]
    Long {
        /// First step.
        from: u64,
        /// The step after the last.
        to: u64,
    },
}

impl Window {
    /// Steps of the longest window.
    pub const MOST_STEPS: u64 = 1000;

    /// From a step on, up to another that is no longer part of it.
    ///
    /// # Errors
    /// There are no such steps, or too many.
    pub fn new(from: u64, to: u64) -> Result<Self, BadWindow> {
        match to.checked_sub(from) {
            None | Some(0) => Err(BadWindow::Empty { from, to }),
            Some(steps) if steps > Self::MOST_STEPS => Err(BadWindow::Long { from, to }),
            Some(_) => Ok(Self { from, to }),
        }
    }

    /// The first step.
    pub fn first(&self) -> u64 {
        self.from
    }

    /// The last step.
    pub fn last(&self) -> u64 {
        self.to - 1
    }

    /// Number of steps.
    pub fn steps(&self) -> u64 {
        self.to - self.from
    }

    /// Whether a step comes before the window (less), in it (equal) or after it (greater).
    pub fn place(&self, step: u64) -> Ordering {
        match step {
            step if step < self.from => Ordering::Less,
            step if step < self.to => Ordering::Equal,
            _ => Ordering::Greater,
        }
    }
}

impl FromStr for Window {
    type Err = BadWindow;

    fn from_str(text: &str) -> Result<Self, BadWindow> {
        let form = || BadWindow::Form(text.to_owned());
        let (from, to) = text.split_once("..").ok_or_else(form)?;
        let step = |text: &str| text.trim().parse::<u64>().map_err(|_| form());
        Self::new(step(from)?, step(to)?)
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", self.from, self.to)
    }
}

//! The link's conformance suite over both transports, and what only processes can do.

use halfstep_tests::conformance::link::{faults, suite};

/// One test for each case of the suite.
macro_rules! conformance {
    ($name:ident, $transport:ty) => {
        mod $name {
            use super::{faults, suite};

            #[test]
            fn any_start_order() {
                suite::any_start_order::<$transport>();
            }

            #[test]
            fn long_run() {
                suite::long_run::<$transport>(2000);
            }

            #[test]
            fn several_runs() {
                suite::several_runs::<$transport>();
            }

            #[test]
            fn several_solids() {
                suite::several_solids::<$transport>();
            }

            #[test]
            fn role_taken() {
                suite::role_taken::<$transport>();
            }

            #[test]
            fn handshake_timeout() {
                suite::handshake_timeout::<$transport>();
            }

            #[test]
            fn peer_leaves() {
                suite::peer_leaves::<$transport>();
            }

            #[test]
            fn last_message() {
                suite::last_message::<$transport>();
            }

            #[test]
            fn silence() {
                suite::silence::<$transport>();
            }

            #[test]
            fn patience() {
                suite::patience::<$transport>();
            }

            #[test]
            fn abort() {
                suite::abort::<$transport>();
            }

            #[test]
            fn capacity() {
                suite::capacity::<$transport>();
            }

            #[test]
            fn incompatible_processes() {
                suite::incompatible_processes::<$transport>();
            }

            #[test]
            fn wrong_states() {
                faults::wrong_states::<$transport>();
            }

            #[test]
            fn wrong_forces() {
                faults::wrong_forces::<$transport>();
            }
        }
    };
}

conformance!(processes, halfstep_link::Processes);
conformance!(threads, halfstep_link::Threads);

//! The one place where a scene's dimension becomes a type.

/// Evaluates an expression with the dimension as the constant `D`: `None` where the program is not compiled for it.
///
/// Everything below is generic over `D`. A dimension that scenes may have is one more line here; a test holds that the
/// program names no dimension elsewhere.
///
/// ```
/// let corners = halfstep_scene::dispatch!(2, D => 1 << D);
/// assert_eq!(corners, Some(4));
/// assert_eq!(halfstep_scene::dispatch!(7, D => 1 << D), None);
/// ```
#[macro_export]
macro_rules! dispatch {
    ($dimension:expr, $D:ident => $body:expr) => {
        match $dimension {
            2 => {
                const $D: usize = 2;
                Some($body)
            }
            _ => None,
        }
    };
}

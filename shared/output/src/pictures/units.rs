//! Numbers as people read them on an axis.

/// Factor and unit in which values of `unit` up to `largest` (in absolute value) are shown: a tip that moves by
/// 0.03 m is shown in mm.
pub fn shown(unit: &str, largest: f64) -> (f64, String) {
    let scales: &[(f64, f64, &str)] = match unit {
        "m" => &[(1e-4, 1e6, "µm"), (0.1, 1e3, "mm")],
        "s" => &[(0.05, 1e3, "ms")],
        "Pa" => &[(2e3, 1.0, "Pa"), (2e6, 1e-3, "kPa"), (2e9, 1e-6, "MPa"), (f64::INFINITY, 1e-9, "GPa")],
        "J" => &[(1e-4, 1e6, "µJ"), (0.1, 1e3, "mJ"), (2e3, 1.0, "J"), (f64::INFINITY, 1e-3, "kJ")],
        _ => &[],
    };
    let scale = scales.iter().find(|(below, ..)| largest < *below && largest > 0.0);
    scale.map_or((1.0, unit.into()), |&(_, factor, name)| (factor, name.into()))
}

/// Steps between ticks, over a power of ten.
const TICKS: &[f64] = &[1.0, 2.0, 2.5, 5.0, 10.0];
/// Ends of a scale, over a power of ten.
const ENDS: &[f64] = &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// The smallest step between ticks that is not below `value` (positive): 1, 2, 2.5 or 5 times a power of ten.
pub(crate) fn tick_step(value: f64) -> f64 {
    round_up(value, TICKS)
}

/// A round number not below `value` (positive) and at most half as much again.
pub(crate) fn scale_end(value: f64) -> f64 {
    round_up(value, ENDS)
}

fn round_up(value: f64, steps: &[f64]) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let step = steps.iter().find(|step| *step * power >= value * (1.0 - 1e-9));
    step.unwrap_or(&10.0) * power
}

/// A number with three significant digits and no superfluous zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { value.to_string() };
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.*}", (2 - magnitude).max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_size() {
        assert_eq!(shown("m", 0.03), (1e3, "mm".into()));
        assert_eq!(shown("m", 0.3), (1.0, "m".into()));
        assert_eq!(shown("m", 0.0), (1.0, "m".into()));
        assert_eq!(shown("Pa", 1500.0), (1.0, "Pa".into()));
        assert_eq!(shown("Pa", 1.2e7), (1e-6, "MPa".into()));
        assert_eq!(shown("J", 5e5), (1e-3, "kJ".into()));
        assert_eq!(shown("rad", 5e5), (1.0, "rad".into()));
    }

    #[test]
    fn rounding_up_stays_close() {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        for (value, step) in
            [(1.0, 1.0), (1.1, 2.0), (0.021, 0.025), (3100.0, 5000.0), (6.0, 10.0), (1e3, 1e3)]
        {
            assert!(close(tick_step(value), step), "{value}: {}", tick_step(value));
        }
        for (value, end) in [(1.0, 1.0), (1.1, 1.5), (0.021, 0.025), (3100.0, 4000.0), (6.0, 6.0), (9e5, 1e6)]
        {
            assert!(close(scale_end(value), end), "{value}: {}", scale_end(value));
        }
    }

    #[test]
    fn numbers_are_short() {
        let shown: Vec<_> = [0.0, 0.1, -2.5, 0.30000000000000004, 1234.4, 1e9, 2e-7].map(number).to_vec();
        assert_eq!(shown, ["0", "0.1", "-2.5", "0.3", "1234", "1.00e9", "2.00e-7"]);
    }
}

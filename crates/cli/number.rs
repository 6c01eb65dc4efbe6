/// A measured number in few digits: plain where it has a usual size, else with an exponent.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&size) {
        format!("{value:.5}")
    } else {
        format!("{value:.3e}")
    }
}

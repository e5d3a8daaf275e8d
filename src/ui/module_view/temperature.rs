//! Degrees Celsius and Fahrenheit, for what a module has in one unit only.

use crate::ui::settings::TemperatureUnit;

/// A temperature in another unit; `None` where `from` and `to` are not both temperatures or the same unit.
pub fn converted(value: f64, from: &str, to: &str) -> Option<f64> {
    let (celsius, fahrenheit) = (TemperatureUnit::Celsius.symbol(), TemperatureUnit::Fahrenheit.symbol());
    match (from, to) {
        _ if from == to => Some(value),
        _ if from == celsius && to == fahrenheit => Some(value * 9.0 / 5.0 + 32.0),
        _ if from == fahrenheit && to == celsius => Some((value - 32.0) * 5.0 / 9.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boiling_and_freezing_are_where_they_belong() {
        for (celsius, fahrenheit) in [(0.0, 32.0), (100.0, 212.0), (-40.0, -40.0)] {
            assert_eq!(converted(celsius, "°C", "°F"), Some(fahrenheit));
            assert_eq!(converted(fahrenheit, "°F", "°C"), Some(celsius));
        }
        assert_eq!(converted(50.0, "%", "%"), Some(50.0));
        assert_eq!(converted(50.0, "%", "°C"), None);
    }
}

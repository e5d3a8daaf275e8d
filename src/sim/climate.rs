//! The air around a module: a plausible course of temperature and humidity that is the same at every run.

use std::f64::consts::TAU;
use std::time::Duration;

/// Values are kept in hundredths, as the registers and the DCON answers have them (PIR-234 manual 6.1).
pub(super) type Hundredths = i32;

/// The five analogue channels in the order of registers 1 to 5: temperature in °C and °F, relative humidity in %, dew
/// point in °C and °F, each in hundredths.
pub(super) type Channels = [Hundredths; 5];

const DAY_S: f64 = 86_400.0;
const MEAN_C: f64 = 21.0;
const DAILY_SWING_C: f64 = 4.0;

/// Where temperature and humidity come from: computed from the time, or frozen by a test.
#[derive(Debug, Clone)]
pub(super) struct Climate {
    seed: u64,
    frozen_c: Option<f64>,
    frozen_humidity: Option<f64>,
}

impl Climate {
    pub fn new(seed: u64) -> Self {
        Self { seed, frozen_c: None, frozen_humidity: None }
    }

    /// From now on the air has this temperature in °C, before the module's offset.
    pub fn freeze_temperature(&mut self, celsius: f64) {
        self.frozen_c = Some(celsius);
    }

    /// From now on the air has this relative humidity in %, before the module's offset.
    pub fn freeze_humidity(&mut self, percent: f64) {
        self.frozen_humidity = Some(percent);
    }

    /// A few steps away the air is another: the seed of its course, or what it was frozen at, is.
    pub fn elsewhere(&self) -> Self {
        Self {
            seed: mix(self.seed),
            frozen_c: self.frozen_c.map(|celsius| celsius + 3.75),
            frozen_humidity: self.frozen_humidity.map(|percent| percent + 7.5),
        }
    }

    /// What a module with these offsets measures at `time`.
    pub fn channels(&self, time: Duration, temperature_offset: Hundredths, humidity_offset: Hundredths) -> Channels {
        let wave = self.wave(time);
        let celsius = self.frozen_c.unwrap_or(MEAN_C + wave) + f64::from(temperature_offset) / 100.0;
        let humidity = self.frozen_humidity.unwrap_or_else(|| self.humidity(time, wave));
        let humidity = (humidity + f64::from(humidity_offset) / 100.0).clamp(0.0, 100.0);
        let dew_point = dew_point_c(celsius, humidity);
        [celsius, fahrenheit(celsius), humidity, dew_point, fahrenheit(dew_point)].map(hundredths)
    }

    /// Distance from the mean temperature in °C: the day, a ripple over minutes and a little sensor noise.
    fn wave(&self, time: Duration) -> f64 {
        let seconds = time.as_secs_f64();
        let phase = unit(mix(self.seed));
        let daily = DAILY_SWING_C * (TAU * (seconds / DAY_S + phase)).sin();
        let ripple = 0.25 * (TAU * (seconds / 170.0 + phase)).sin() + 0.12 * (TAU * seconds / 43.0).sin();
        daily + ripple + 0.02 * self.noise(time, 1)
    }

    /// Warm air takes up more water, so the relative humidity runs against the temperature.
    fn humidity(&self, time: Duration, wave: f64) -> f64 {
        let slow = 1.5 * (TAU * time.as_secs_f64() / 610.0).sin();
        (50.0 - 2.6 * wave + slow + 0.05 * self.noise(time, 2)).clamp(5.0, 95.0)
    }

    /// -1 to 1, another value each half second.
    fn noise(&self, time: Duration, salt: u64) -> f64 {
        let half_seconds = u64::try_from(time.as_millis() / 500).unwrap_or(u64::MAX);
        2.0 * unit(mix(self.seed ^ mix(half_seconds ^ (salt << 48)))) - 1.0
    }
}

/// Spreads the bits of `value`: the finalizer of SplitMix64.
pub(super) fn mix(value: u64) -> u64 {
    let value = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    value ^ (value >> 31)
}

/// 0 to 1.
fn unit(bits: u64) -> f64 {
    f64::from((bits >> 32) as u32) / f64::from(u32::MAX)
}

fn fahrenheit(celsius: f64) -> f64 {
    celsius * 9.0 / 5.0 + 32.0
}

/// Magnus formula with the coefficients of Sonntag (1990), good to 0.4 °C from -45 to 60 °C.
fn dew_point_c(celsius: f64, humidity: f64) -> f64 {
    const A: f64 = 17.62;
    const B: f64 = 243.12;
    let saturation = (humidity.max(0.01) / 100.0).ln() + A * celsius / (B + celsius);
    B * saturation / (A - saturation)
}

/// Rounded, and within what a signed register can hold.
fn hundredths(value: f64) -> Hundredths {
    (value * 100.0).round().clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as Hundredths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frozen_climate_gives_all_five_channels() {
        let mut climate = Climate::new(1);
        climate.freeze_temperature(30.0);
        climate.freeze_humidity(50.0);
        assert_eq!(climate.channels(Duration::ZERO, 0, 0), [3000, 8600, 5000, 1844, 6519]);
        assert_eq!(climate.channels(Duration::ZERO, -125, 300)[..3], [2875, 8375, 5300]);
    }

    #[test]
    fn the_course_is_plausible_the_same_each_time_and_never_still() {
        let climate = Climate::new(7);
        let mut before = None;
        for minute in 0..3 * 24 * 60 {
            let time = Duration::from_secs(minute * 60);
            let channels = climate.channels(time, 0, 0);
            assert!((1600..2600).contains(&channels[0]), "{channels:?}");
            assert!((3000..7000).contains(&channels[2]), "{channels:?}");
            assert!(channels[3] < channels[0], "{channels:?}");
            assert_eq!(climate.channels(time, 0, 0), channels);
            assert_ne!(before.replace(channels), Some(channels));
        }
    }

    #[test]
    fn no_frozen_value_leaves_the_range_of_a_register() {
        let mut climate = Climate::new(1);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -243.12, -1e300, 1e300] {
            climate.freeze_temperature(value);
            climate.freeze_humidity(value);
            for channel in climate.channels(Duration::ZERO, 0, 0) {
                assert!(i16::try_from(channel).is_ok(), "{value}: {channel}");
            }
        }
    }
}

//! Who walks past a module: plausible visits that are the same at every run.

use std::time::Duration;

use super::climate::mix;

/// Whether each of the four sensors sees someone; a PIR-130 looks through one window and takes any of them.
pub(super) type Sensors = [bool; 4];

/// Visits and pauses, or what a test says.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    seed: u64,
    count: u64,
    visit: Visit,
    said: Option<Sensors>,
}

#[derive(Debug, Clone)]
struct Visit {
    from: Duration,
    to: Duration,
    first_sensor: usize,
    /// How long the visitor stays in front of one sensor.
    dwell: Duration,
}

impl Motion {
    pub fn new(seed: u64) -> Self {
        let nobody = Visit { from: Duration::ZERO, to: Duration::ZERO, first_sensor: 0, dwell: Duration::MAX };
        Self { seed, count: 0, visit: nobody, said: None }
    }

    /// From now on there are no visits; `sensor` is 1 to 4 as in the manual, or 0 for all of them.
    pub fn say(&mut self, sensor: usize, seen: bool) {
        let sensors = self.said.get_or_insert_default();
        match sensor.checked_sub(1) {
            None => *sensors = [seen; 4],
            Some(index) => {
                if let Some(one) = sensors.get_mut(index) {
                    *one = seen;
                }
            }
        }
    }

    /// What the sensors see at `time`, which never runs backwards.
    pub fn at(&mut self, time: Duration) -> Sensors {
        if let Some(said) = self.said {
            return said;
        }
        while time >= self.visit.to {
            self.visit = self.next_visit();
        }
        self.visit.at(time)
    }

    /// After a pause of 10 to 90 s someone stays for 5 to 60 s.
    fn next_visit(&mut self) -> Visit {
        self.count = self.count.wrapping_add(1);
        let dice = mix(self.seed ^ mix(self.count));
        let roll = |shift: u32, low: u64, high: u64| low + (dice >> shift) % (high - low);
        let from = self.visit.to + Duration::from_millis(roll(0, 10_000, 90_000));
        Visit {
            from,
            to: from + Duration::from_millis(roll(17, 5_000, 60_000)),
            first_sensor: (dice >> 60) as usize,
            dwell: Duration::from_millis(roll(34, 1_500, 6_000)),
        }
    }
}

impl Visit {
    fn at(&self, time: Duration) -> Sensors {
        let mut sensors = Sensors::default();
        let Some(since) = time.checked_sub(self.from) else { return sensors };
        let dwell = self.dwell.as_millis().max(1);
        let steps = usize::try_from(since.as_millis() / dwell).unwrap_or_default();
        let here = self.first_sensor.wrapping_add(steps);
        // On the way over, the next sensor sees the visitor while the last one still does.
        let leaving = since.as_millis() % dwell * 4 >= dwell * 3;
        for sensor in [Some(here), leaving.then(|| here.wrapping_add(1))].into_iter().flatten() {
            if let Some(seen) = sensors.get_mut(sensor % 4) {
                *seen = true;
            }
        }
        sensors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn someone_passes_every_sensor_within_an_hour_and_the_room_is_often_empty() {
        let mut motion = Motion::new(3);
        let (mut seen, mut busy) = ([0; 4], 0);
        for second in 0..3600 {
            let sensors = motion.at(Duration::from_secs(second));
            busy += usize::from(sensors.contains(&true));
            for (count, sensor) in seen.iter_mut().zip(sensors) {
                *count += usize::from(sensor);
            }
        }
        assert!(seen.iter().all(|&count| count > 60), "{seen:?}");
        assert!((600..2400).contains(&busy), "{busy}");
    }

    #[test]
    fn what_a_test_says_replaces_the_visits() {
        let mut motion = Motion::new(3);
        motion.say(2, true);
        assert_eq!(motion.at(Duration::from_secs(1)), [false, true, false, false]);
        motion.say(0, true);
        motion.say(4, false);
        motion.say(5, false);
        assert_eq!(motion.at(Duration::from_secs(9000)), [true, true, true, false]);
    }
}

use super::*;

const WINDOW: Duration = Duration::from_millis(200);
const SECOND: Duration = Duration::from_secs(1);

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// A line with modules, some of them dead, on which each poll takes its time.
struct Play {
    schedule: Schedule<u8>,
    start: Instant,
    now: Instant,
    poll: Duration,
    dead: Vec<u8>,
    /// Who was asked, and how long after the start.
    asked: Vec<(u8, Duration)>,
}

impl Play {
    fn new(intervals: &[Duration], poll: Duration) -> Self {
        let start = Instant::now();
        let mut schedule = Schedule::default();
        for (key, interval) in (0..).zip(intervals) {
            schedule.add(key, *interval, start);
        }
        Self { schedule, start, now: start, poll, dead: Vec::new(), asked: Vec::new() }
    }

    fn with_dead(mut self, dead: &[u8]) -> Self {
        self.dead = dead.to_vec();
        self
    }

    /// Polls whoever is due until so long after the start.
    fn run_until(&mut self, end: Duration) {
        while self.now < self.start + end {
            let Some(key) = self.schedule.take_due(self.now) else {
                self.now = self.schedule.next_due().expect("a module").min(self.start + end);
                continue;
            };
            self.asked.push((key, self.now - self.start));
            let dead = self.dead.contains(&key);
            self.now += if dead { WINDOW } else { self.poll };
            if dead {
                self.schedule.stayed_silent(key, self.now);
            } else {
                self.schedule.heard(key, self.now);
            }
        }
    }

    fn times(&self, key: u8) -> Vec<Duration> {
        self.asked.iter().filter(|(asked, _)| *asked == key).map(|(_, at)| *at).collect()
    }

    fn gaps(&self, key: u8) -> Vec<Duration> {
        self.times(key).windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}

#[test]
fn modules_polled_as_fast_as_the_line_allows_take_turns() {
    let mut play = Play::new(&[Duration::ZERO; 3], ms(30));
    play.run_until(SECOND);
    let order: Vec<u8> = play.asked.iter().map(|(key, _)| *key).collect();
    assert!(order.chunks_exact(3).all(|turn| turn == [0, 1, 2]), "{order:?}");
    assert_eq!(order.len(), 34, "the line is never idle");
}

#[test]
fn a_module_with_an_interval_keeps_its_rhythm_among_those_without() {
    let mut play = Play::new(&[SECOND, Duration::ZERO, Duration::ZERO], ms(30));
    play.run_until(SECOND * 20);
    for (second, at) in (0u32..).zip(play.times(0)) {
        assert!(at >= SECOND * second && at <= SECOND * second + ms(90), "{second}: {at:?}");
    }
    assert_eq!(play.times(0).len(), 20);
}

#[test]
fn missed_polls_are_not_caught_up_and_the_rhythm_stays() {
    let mut play = Play::new(&[SECOND], ms(30));
    play.run_until(ms(500));
    play.now += ms(5_200);
    play.run_until(SECOND * 9);
    assert_eq!(play.times(0), [0, 5_700, 6_000, 7_000, 8_000].map(ms));
}

#[test]
fn an_interval_that_the_line_cannot_keep_leaves_it_no_pause() {
    let mut play = Play::new(&[ms(100)], ms(120));
    play.run_until(SECOND * 12);
    assert_eq!(play.times(0).len(), 100);
}

#[test]
fn a_silent_module_is_probed_at_its_interval_for_ten_seconds_then_rarely_and_delays_the_others_by_one_window() {
    let mut play = Play::new(&[SECOND; 4], ms(30)).with_dead(&[2]);
    play.run_until(SECOND * 60);
    let rests: Vec<Duration> = play.gaps(2).iter().map(|gap| *gap - WINDOW).collect();
    let short = rests.iter().take_while(|rest| **rest <= SECOND + ms(90)).count();
    assert!((8..=10).contains(&short), "{rests:?}");
    // It may have to wait for another's poll.
    assert!(rests[short..].iter().all(|rest| *rest >= SECOND * 10 && *rest <= SECOND * 10 + ms(90)), "{rests:?}");
    for living in [0, 1, 3] {
        let times = play.times(living);
        assert_eq!(times.len(), 60, "no poll of {living} is lost");
        for (second, at) in (0u32..).zip(times) {
            assert!(at - SECOND * second <= WINDOW + ms(90), "{living} at {second}: {at:?}");
        }
    }
}

#[test]
fn several_silent_modules_take_half_of_the_line_together_at_most() {
    let mut play = Play::new(&[SECOND; 8], ms(20)).with_dead(&[1, 3, 5, 7]);
    play.run_until(SECOND * 10);
    let probes: usize = [1, 3, 5, 7].iter().map(|dead| play.times(*dead).len()).sum();
    // The first four were not known to be silent.
    assert!(WINDOW * (probes as u32 - 4) <= SECOND * 10 / 2 + WINDOW, "{probes}");
    assert!(play.times(0).len() >= 9, "{:?}", play.times(0));
}

#[test]
fn modules_that_fell_silent_together_are_all_due_when_one_of_them_answers() {
    let start = Instant::now();
    let mut schedule = Schedule::default();
    ["living", "one", "other", "dead"].iter().for_each(|key| schedule.add(*key, SECOND, start));
    schedule.stayed_silent("dead", start);
    let fell = start + SECOND * 60;
    schedule.stayed_silent("one", fell);
    schedule.stayed_silent("other", fell + SECOND * 2);
    schedule.heard("one", fell + ms(2_100));
    let due: Vec<_> = std::iter::from_fn(|| schedule.take_due(fell + ms(2_100))).take(4).collect();
    assert!(due.contains(&"other"), "{due:?}");
}

#[test]
fn without_an_interval_the_cost_of_a_probe_is_what_grows() {
    let mut play = Play::new(&[Duration::ZERO; 2], ms(30)).with_dead(&[0]);
    play.run_until(SECOND * 40);
    let rests: Vec<Duration> = play.gaps(0).iter().map(|gap| *gap - WINDOW).collect();
    for (rest, least) in rests.iter().zip([400, 800, 1_600, 3_200, 6_400, 10_000].map(ms)) {
        assert!(*rest >= least && *rest <= least + ms(60), "{rests:?}");
    }
}

#[test]
fn a_module_that_answers_again_is_back_at_its_interval() {
    let mut play = Play::new(&[SECOND; 2], ms(30)).with_dead(&[1]);
    play.run_until(SECOND * 30);
    play.dead.clear();
    play.run_until(SECOND * 60);
    let gaps = play.gaps(1);
    assert_eq!(gaps[gaps.len() - 15..], [SECOND; 15]);
}

#[test]
fn an_answer_to_another_question_ends_the_respite_of_a_silent_module() {
    let mut play = Play::new(&[SECOND; 2], ms(30)).with_dead(&[1]);
    play.run_until(SECOND * 30);
    assert!(play.schedule.is_silent(1));
    play.schedule.heard(1, play.now);
    assert!(!play.schedule.is_silent(1));
    play.dead.clear();
    let before = play.asked.len();
    play.run_until(SECOND * 32);
    assert!(play.asked[before..].iter().any(|(key, _)| *key == 1));
}

#[test]
fn an_interval_longer_than_the_longest_respite_is_kept_by_a_silent_module() {
    let long = SECOND * 60;
    let mut play = Play::new(&[long, SECOND], ms(30)).with_dead(&[0]);
    play.run_until(SECOND * 400);
    assert!(play.gaps(0).iter().all(|gap| *gap >= long && *gap <= long + WINDOW + ms(30)), "{:?}", play.gaps(0));
}

#[test]
fn where_nobody_answers_nobody_is_left_alone_for_long() {
    let mut play = Play::new(&[SECOND, Duration::ZERO], ms(30)).with_dead(&[0]);
    play.run_until(SECOND * 30);
    // The other one falls silent while the first has a long respite.
    play.dead.push(1);
    play.run_until(SECOND * 60);
    for key in [0, 1] {
        let late: Vec<_> = play.times(key).into_iter().filter(|at| *at > SECOND * 33).collect();
        let gaps: Vec<_> = late.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(gaps.iter().all(|gap| *gap >= SECOND && *gap <= SECOND * 2 + WINDOW * 2), "{key}: {gaps:?}");
        assert!(late.len() > 10, "{key}: {late:?}");
    }
}

#[test]
fn when_the_line_itself_was_at_fault_all_are_asked_as_soon_as_one_answers() {
    let mut play = Play::new(&[SECOND * 5; 4], ms(30)).with_dead(&[0, 1, 2, 3]);
    play.run_until(SECOND * 60);
    play.dead.clear();
    let before = play.asked.len();
    play.run_until(SECOND * 70);
    let (_, first) = play.asked[before];
    let others = &play.asked[before + 1..before + 4];
    assert!(others.iter().all(|(_, at)| *at <= first + ms(90)), "{:?}", &play.asked[before..]);
}

#[test]
fn on_a_line_that_is_there_again_all_are_due_at_once() {
    let mut play = Play::new(&[SECOND; 3], ms(30)).with_dead(&[2]);
    play.run_until(SECOND * 30);
    play.schedule.begin_anew(play.now);
    assert!((0..3).all(|key| !play.schedule.is_silent(key)));
    let due: Vec<_> = (0..3).filter_map(|_| play.schedule.take_due(play.now)).collect();
    assert_eq!(due.len(), 3);
}

#[test]
fn a_probe_that_fails_at_once_is_not_repeated_at_once() {
    let mut schedule = Schedule::default();
    let start = Instant::now();
    schedule.add(1, Duration::ZERO, start);
    assert_eq!(schedule.take_due(start), Some(1));
    schedule.stayed_silent(1, start);
    assert_eq!(schedule.next_due(), Some(start + SHORTEST_COST * 2));
}

#[test]
fn a_module_that_refuses_everything_is_asked_once_a_second() {
    let mut schedule = Schedule::default();
    let start = Instant::now();
    schedule.add(1, Duration::ZERO, start);
    assert_eq!(schedule.take_due(start), Some(1));
    schedule.heard(1, start + ms(30));
    schedule.refuses_all(1);
    assert_eq!(schedule.next_due(), Some(start + SECOND));
}

#[test]
fn what_is_let_go_or_moved_is_known_by_its_new_name_or_not_at_all() {
    let mut schedule = Schedule::default();
    let start = Instant::now();
    (1..=2).for_each(|key| schedule.add(key, SECOND, start));
    schedule.rename(2, 9);
    schedule.remove(1);
    assert_eq!(schedule.take_due(start), Some(9));
    schedule.stayed_silent(1, start);
    assert_eq!(schedule.take_due(start), None);
}

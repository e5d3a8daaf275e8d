//! Looks for ports and adapters without making anyone wait: some systems take seconds to tell.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// Looks for something on a thread of its own, one look at a time.
pub struct Lookout<T> {
    name: &'static str,
    look: Arc<dyn Fn() -> T + Send + Sync>,
    wake: Arc<dyn Fn() + Send + Sync>,
    under_way: Option<Receiver<T>>,
    /// A look was asked for while another was under way, which may have begun before what is to be seen was there.
    again: bool,
}

impl<T: Send + 'static> Lookout<T> {
    /// `name` is that of the thread.
    pub fn new(name: &'static str, look: impl Fn() -> T + Send + Sync + 'static) -> Self {
        Self { name, look: Arc::new(look), wake: Arc::new(|| {}), under_way: None, again: false }
    }

    /// Lets `wake` be called when a look has ended.
    pub fn wake_with(&mut self, wake: Arc<dyn Fn() + Send + Sync>) {
        self.wake = wake;
    }

    /// Looks now, and once more if a look is under way.
    pub fn look(&mut self) {
        match self.under_way {
            Some(_) => self.again = true,
            None => self.begin(),
        }
    }

    /// Whether something was asked for that is not seen yet.
    pub fn is_looking(&self) -> bool {
        self.under_way.is_some()
    }

    /// What a look that has ended has seen, once.
    pub fn take(&mut self) -> Option<T> {
        let seen = match self.under_way.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(seen) => Some(seen),
            Err(TryRecvError::Disconnected) => None,
        };
        self.under_way = None;
        if std::mem::take(&mut self.again) {
            self.begin();
        }
        seen
    }

    fn begin(&mut self) {
        let (answer, under_way) = sync_channel(1);
        let (look, wake) = (self.look.clone(), self.wake.clone());
        let work = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = answer.send(look());
            wake();
        };
        match std::thread::Builder::new().name(self.name.to_owned()).spawn(work) {
            Ok(_) => self.under_way = Some(under_way),
            Err(error) => log::warn!("{} are not looked for: {error}", self.name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::mpsc::{Sender, channel};

    /// A lookout whose looks end when they are told what to see, and what tells that one has ended.
    fn scripted() -> (Lookout<u32>, Sender<u32>, Receiver<()>) {
        let (see, script) = channel();
        let script = Mutex::new(script);
        let mut lookout = Lookout::new("test", move || script.lock().unwrap().recv().unwrap());
        let (woken, wakes) = sync_channel(10);
        lookout.wake_with(Arc::new(move || woken.send(()).unwrap()));
        (lookout, see, wakes)
    }

    #[test]
    fn nothing_is_seen_before_a_look_has_ended_and_everything_once() {
        let (mut lookout, see, wakes) = scripted();
        assert!(!lookout.is_looking() && lookout.take().is_none());
        lookout.look();
        assert!(lookout.is_looking() && lookout.take().is_none());
        see.send(1).unwrap();
        wakes.recv().unwrap();
        assert_eq!(lookout.take(), Some(1));
        assert!(!lookout.is_looking() && lookout.take().is_none());
    }

    #[test]
    fn however_often_it_is_asked_meanwhile_one_more_look_follows() {
        let (mut lookout, see, wakes) = scripted();
        (0..3).for_each(|_| lookout.look());
        for seen in [1, 2] {
            see.send(seen).unwrap();
            wakes.recv().unwrap();
            assert!(lookout.is_looking());
            assert_eq!(lookout.take(), Some(seen));
        }
        assert!(!lookout.is_looking());
    }

    #[test]
    fn a_look_that_fails_ends_and_shows_nothing() {
        let (mut lookout, see, _wakes) = scripted();
        lookout.look();
        drop(see);
        while lookout.is_looking() {
            assert_eq!(lookout.take(), None);
            std::thread::yield_now();
        }
    }
}

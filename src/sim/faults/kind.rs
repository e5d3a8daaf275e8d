//! Which faults there are, how strong each can be, and how both are said.

use std::fmt;
use std::str::FromStr;

use crate::protocol::BaudRate;

/// One way in which a simulated line goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaultKind {
    /// Bytes with one bit changed.
    Flipped,
    /// Bytes that do not arrive.
    Lost,
    /// Bytes that nobody sent.
    Inserted,
    /// 00 or FF before and after an answer, as on a line without bias or termination.
    Noise,
    /// Answers that come when nobody waits for them any more.
    Late,
    /// Answers whose end is missing.
    Cut,
    /// Answers that come twice.
    Doubled,
    /// Answers that carry the address of another module, with a right checksum or CRC.
    WrongAddress,
    /// Answers with a wrong checksum or CRC.
    WrongChecksum,
    /// The adapter sends back what is sent.
    Echo,
    /// The adapter sends back the beginning of what is sent.
    PartialEcho,
    /// A second module, with other values, at the address of one that is there.
    Twin,
    /// All modules answer requests of this speed with bytes that make no sense.
    WrongSpeed,
    /// The adapter is gone.
    Unplugged,
    /// The adapter is there under another name.
    Renamed,
    /// The port takes no bytes.
    BlockedWrite,
    /// The system's clock was set to another time.
    ClockJump,
}

/// How strong a fault is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strength {
    On,
    /// The chance of each byte or answer, 0 to 1.
    Rate(f64),
    /// Of the module that it concerns.
    Address(u8),
    Speed(BaudRate),
    /// Forward, or back if negative.
    Seconds(i64),
}

/// A fault with its strength, as the command line says it: `flipped=1%`, `echo`, `twin=0xA3`, `wrong_speed=19200`,
/// `clock_jump=-3600`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    pub kind: FaultKind,
    pub strength: Strength,
}

/// A word that names no fault, or a strength that a fault cannot have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FaultError(String);

use FaultKind::*;

impl FaultKind {
    pub const ALL: [Self; 17] = [
        Flipped,
        Lost,
        Inserted,
        Noise,
        Late,
        Cut,
        Doubled,
        WrongAddress,
        WrongChecksum,
        Echo,
        PartialEcho,
        Twin,
        WrongSpeed,
        Unplugged,
        Renamed,
        BlockedWrite,
        ClockJump,
    ];

    /// The word of the command line.
    pub fn word(self) -> &'static str {
        match self {
            Flipped => "flipped",
            Lost => "lost",
            Inserted => "inserted",
            Noise => "noise",
            Late => "late",
            Cut => "cut",
            Doubled => "doubled",
            WrongAddress => "wrong_address",
            WrongChecksum => "wrong_checksum",
            Echo => "echo",
            PartialEcho => "partial_echo",
            Twin => "twin",
            WrongSpeed => "wrong_speed",
            Unplugged => "unplugged",
            Renamed => "renamed",
            BlockedWrite => "blocked_write",
            ClockJump => "clock_jump",
        }
    }

    /// For a person.
    pub fn label(self) -> &'static str {
        match self {
            Flipped => "Flipped bits",
            Lost => "Lost bytes",
            Inserted => "Inserted bytes",
            Noise => "Stray 00 or FF",
            Late => "Late answers",
            Cut => "Cut answers",
            Doubled => "Doubled answers",
            WrongAddress => "Wrong address",
            WrongChecksum => "Wrong checksum or CRC",
            Echo => "Echo",
            PartialEcho => "Partial echo",
            Twin => "Two modules at one address",
            WrongSpeed => "Garbage at one speed",
            Unplugged => "Adapter unplugged",
            Renamed => "Adapter under another name",
            BlockedWrite => "Port takes no bytes",
            ClockJump => "Clock set to another time",
        }
    }

    /// What it is on a real line, in one sentence without a full stop.
    pub fn explanation(self) -> &'static str {
        match self {
            Flipped => "One bit of a byte arrives changed, as with interference or a worn contact; both ways",
            Lost => "A byte does not arrive; both ways",
            Inserted => "A byte arrives that nobody sent; both ways",
            Noise => "Stray bytes around an answer, as without bias or termination",
            Late => "An answer comes when its time is over, as from a busy adapter, hub or virtual machine",
            Cut => "The end of an answer is missing",
            Doubled => "An answer comes twice, as through a repeater that reflects",
            WrongAddress => "An answer carries another module's address",
            WrongChecksum => "An answer's checksum or CRC does not fit its bytes",
            Echo => "The adapter hears itself: everything sent comes back first",
            PartialEcho => "Only the beginning of what is sent comes back",
            Twin => "A second module with other values answers at the address of the first",
            WrongSpeed => "What is sent at this speed is answered with bytes that make no sense",
            Unplugged => "The adapter is pulled; off again, it is back",
            Renamed => "The adapter comes back under another name, as after another one was plugged in first",
            BlockedWrite => "The port takes no bytes, as when its flow control waits for ever",
            ClockJump => "The computer's clock is set while the line is in use",
        }
    }

    /// What it is when switched on without a strength.
    pub fn default_strength(self) -> Strength {
        match self {
            Flipped | Lost | Inserted => Strength::Rate(0.002),
            Noise | Late | Cut | Doubled | WrongAddress | WrongChecksum => Strength::Rate(0.1),
            Echo | PartialEcho | Unplugged | Renamed | BlockedWrite => Strength::On,
            Twin => Strength::Address(1),
            WrongSpeed => Strength::Speed(BaudRate::default()),
            ClockJump => Strength::Seconds(3_600),
        }
    }

    /// `strength`, if this fault can have it.
    pub fn admits(self, strength: Strength) -> Result<Strength, FaultError> {
        let fits = match (self.default_strength(), strength) {
            (Strength::On, Strength::On)
            | (Strength::Address(_), Strength::Address(_))
            | (Strength::Speed(_), Strength::Speed(_)) => true,
            (Strength::Rate(_), Strength::Rate(rate)) => (0.0..=1.0).contains(&rate),
            (Strength::Seconds(_), Strength::Seconds(seconds)) => seconds.unsigned_abs() <= LONGEST_JUMP,
            _ => false,
        };
        if fits { Ok(strength) } else { Err(FaultError(format!("{}: {}", self.word(), self.usage()))) }
    }

    /// What its strength looks like.
    pub fn usage(self) -> &'static str {
        match self.default_strength() {
            Strength::On => "has no strength: it is on or off",
            Strength::Rate(_) => "the strength is a share such as 0.5% or 0.005, up to 100%",
            Strength::Address(_) => "the strength is the address of a module, such as 1 or 0xA3",
            Strength::Speed(_) => "the strength is a speed such as 9600",
            Strength::Seconds(_) => "the strength is a number of seconds, up to ten years, such as 3600 or -3600",
        }
    }
}

/// Ten years, in seconds.
const LONGEST_JUMP: u64 = 10 * 365 * 86_400;

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind.word())?;
        match self.strength {
            Strength::On => Ok(()),
            Strength::Rate(rate) => write!(f, "={}%", rate * 100.0),
            Strength::Address(address) => write!(f, "={address}"),
            Strength::Speed(speed) => write!(f, "={}", speed.bps()),
            Strength::Seconds(seconds) => write!(f, "={seconds}"),
        }
    }
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (word, strength) = match text.trim().split_once('=') {
            Some((word, strength)) => (word.trim(), Some(strength.trim())),
            None => (text.trim(), None),
        };
        let kind = FaultKind::ALL.into_iter().find(|kind| kind.word() == word).ok_or_else(|| {
            let all: Vec<_> = FaultKind::ALL.into_iter().map(FaultKind::word).collect();
            FaultError(format!("\"{word}\" is no fault: there are {}", all.join(", ")))
        })?;
        let Some(strength) = strength else { return Ok(Self { kind, strength: kind.default_strength() }) };
        let wrong = || FaultError(format!("{word}: {}", kind.usage()));
        let read = match kind.default_strength() {
            Strength::On => return Err(wrong()),
            Strength::Rate(_) => Strength::Rate(rate(strength).ok_or_else(wrong)?),
            Strength::Address(_) => Strength::Address(crate::protocol::parse_address(strength).map_err(|_| wrong())?),
            Strength::Speed(_) => Strength::Speed(strength.parse().map_err(|_| wrong())?),
            Strength::Seconds(_) => Strength::Seconds(strength.parse().map_err(|_| wrong())?),
        };
        Ok(Self { kind, strength: kind.admits(read)? })
    }
}

fn rate(text: &str) -> Option<f64> {
    match text.strip_suffix('%') {
        Some(percent) => Some(percent.trim_end().parse::<f64>().ok()? / 100.0),
        None => text.parse().ok(),
    }
}

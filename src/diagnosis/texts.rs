//! Every symptom with what it is called, its likely cause and the next step. All words on causes stand here.

use serde::Serialize;

use crate::bus::NoPort;

/// The enum, and the list of all its variants, which so cannot lack one.
macro_rules! symptoms {
    ($($(#[$doc:meta])+ $name:ident,)+) => {
        /// Something that is seen on a line, or keeps it from being opened.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Symptom {
            $($(#[$doc])+ $name,)+
        }

        impl Symptom {
            pub const ALL: &[Self] = &[$(Self::$name),+];
        }
    };
}

symptoms! {
    /// Nothing at every address that was asked.
    SilentLine,
    /// The same, and only one protocol was tried.
    SilentInOneProtocol,
    /// Nothing at one address that was asked more than once.
    SilentAddress,
    /// Bytes that cannot be read, from a place that never answered.
    Garbage,
    /// Stray bytes around good answers.
    Noise,
    /// Broken answers that differ from each other.
    ChangingErrors,
    /// Broken answers that are all alike.
    SameErrors,
    /// Broken answers of which it is not known what broke them.
    Unusable,
    /// Identical reads whose answers show more than one module.
    DoubledAddress,
    /// Identical reads whose answers are broken in changing ways.
    DoubledOrNoise,
    /// Answers that come a second time, byte for byte.
    Twice,
    /// The adapter sends back what is sent.
    Echo,
    /// It sends back something else.
    Collision,
    /// Some answers do not come.
    Lost,
    /// Answers that come when they are not waited for any more.
    Late,
    /// It answered and does not any more.
    Stopped,
    /// Answers that end too early.
    CutShort,
    /// Another module answers.
    WrongAddress,
    /// `?AA`, exceptions.
    Refused,
    /// A lone `!`.
    WatchdogTripped,
    /// The port may not be opened.
    NoPermission,
    /// There is no port of this name.
    NoSuchPort,
    /// What was named is no serial port.
    NoSerialPort,
    /// The port goes while it is used.
    PortVanished,
    /// The connection of a network line goes while it is used.
    ConnectionLost,
    /// The host of a network line does not take a connection.
    NotReached,
    /// Another program has the port.
    PortBusy,
    /// The line cannot be opened for another reason.
    NotOpened,
    /// The adapter holds answers back.
    SlowAdapter,
}

impl Symptom {
    /// In a few words.
    pub fn title(self) -> &'static str {
        self.words().0
    }

    /// What is most likely behind it.
    pub fn cause(self) -> &'static str {
        self.words().1
    }

    /// What to do next.
    pub fn next_step(self) -> String {
        match self {
            Self::PortVanished if cfg!(target_os = "linux") => {
                format!("{} {}", self.words().2, NoPort::Brltty.next_step())
            }
            _ => self.words().2.to_owned(),
        }
    }

    /// Cause and next step over a network; `None` where they are the same as on a wire.
    pub(super) fn over_network(self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            Self::SilentLine | Self::SilentInOneProtocol | Self::SilentAddress => (
                "The module has another NetID, or the gateway has no module with this one",
                "Look for it at every NetID (`dcon-bench scan` with --addresses 1-247); behind a gateway, check its speed and \
                 data format, and the wires to the module",
            ),
            Self::Garbage | Self::Unusable | Self::SameErrors | Self::ChangingErrors => (
                "What answers at this port does not speak Modbus TCP as the module does",
                "Check the host and the port number (502 unless it was changed); the traffic shows the bytes in hex",
            ),
            Self::Lost => (
                "The network or a gateway loses them, or the module is busy with others",
                "Check the network's cables, and whether other programs ask the same module",
            ),
            Self::Late => (
                "The timeout is shorter than the module, a gateway or the network takes",
                "Set a longer timeout; behind a gateway, look at the timeout that it has itself",
            ),
            Self::Twice => (
                "A gateway or something else on the way doubles what it passes on",
                "Connect to the module without what is between",
            ),
            Self::Stopped => (
                "Its power or cable is gone, or its NetID was changed",
                "Check its power and the network's cable; then look for it at every NetID",
            ),
            Self::CutShort => (
                "The connection broke off while it answered",
                "Check the network's cables and the module's power under load",
            ),
            Self::WrongAddress => (
                "A gateway mixes up the answers of its modules",
                "Ask the modules one by one, and compare their NetIDs",
            ),
            _ => return None,
        })
    }

    /// Title, cause and next step of what is over.
    pub(super) fn past(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::WatchdogTripped => (
                "The host watchdog had tripped",
                "The module heard no Host OK in time; it was cleared since, and commands are obeyed again",
                "Nothing has to be done; if it trips again, send Host OK more often, or set a longer watchdog timeout",
            ),
            Self::PortVanished => (
                "The port had vanished",
                "The adapter was pulled, or has a bad contact; it is back",
                "Nothing has to be done; if it happens again, try another cable and USB port, without a hub",
            ),
            Self::ConnectionLost => (
                "The connection had broken off",
                "The module or something on the way closed it; it is back",
                "Nothing has to be done; if it happens again, check the network's cables and the module's power",
            ),
            _ => self.words(),
        }
    }

    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::SilentLine => (
                "Nothing answers",
                "No power at the modules, D+ and D− swapped, or this is another port than theirs",
                "Measure the modules' supply, then swap D+ and D− at the adapter, then try the other ports; a full scan \
                 asks at every speed and address",
            ),
            Self::SilentInOneProtocol => (
                "Nothing answers",
                "The modules may speak the other protocol; else no power, D+ and D− swapped, or the wrong port",
                "Try the other protocol (a quick scan asks in both), then swap D+ and D− at the adapter",
            ),
            Self::SilentAddress => (
                "Nothing at this address",
                "The module has another address, protocol or speed: with DIP 2 OFF, as it comes, its switches make it 160 \
                 to 191",
                "Do a quick scan, which asks at 1 and at 160 to 191 in both protocols; then a full one",
            ),
            Self::Garbage => (
                "Bytes that cannot be read",
                "Speed or parity differ from the module's, or D+ and D− are swapped",
                "Try the other speeds and data formats here (a full scan does), then swap D+ and D−; the traffic shows the \
                 bytes in hex",
            ),
            Self::Noise => (
                "Line noise",
                "The line has no bias or termination resistors, or runs beside power cables without a shield",
                "Put 120 Ω between D+ and D− at both ends of the line and bias it at one place; connect the grounds",
            ),
            Self::ChangingErrors => (
                "Answers broken in changing ways",
                "Two modules at one address, or noise on the line",
                "Test the consistency (in the Diagnosis tab, or `dcon-bench diagnose` with --address): it reads the same many \
                 times, which often tells the two apart; then switch off one module after the other",
            ),
            Self::SameErrors => (
                "Answers broken in the same way each time",
                "Program and module do not agree: DCON checksum on one side only, or the other protocol",
                "Do a full scan, which tries both protocols and DCON with and without checksum, and use what it finds",
            ),
            Self::Unusable => (
                "Answers that cannot be used",
                "They are whole, and do not fit what was asked",
                "Look at them in the traffic; a full scan shows whether the module has another protocol or firmware than \
                 expected",
            ),
            Self::DoubledOrNoise => (
                "Two modules at one address, or noise",
                "Broken answers that change each time come from two modules that answer at the same time, or from a line \
                 that is disturbed",
                "Switch off one module after the other and test again: if that ends it, give the one that was off an \
                 address of its own. If not, put 120 Ω between D+ and D− at both ends of the line, bias it at one place \
                 and connect the grounds",
            ),
            Self::Twice => (
                "Answers come twice",
                "A repeater, a busy adapter, a USB hub or a virtual machine doubles what it passes on, or two alike \
                 modules have one address and answer one after the other",
                "Connect the adapter without repeater, hub and virtual machine, and set its latency timer to 1 ms; if they \
                 still come twice, switch off one module after the other",
            ),
            Self::DoubledAddress => (
                "Two modules at one address",
                "Modules as they come, or two with the same rotary switch: they answer at the same time",
                "Switch off one of them and test again; then give the other one an address of its own",
            ),
            Self::Echo => (
                "The adapter echoes",
                "The adapter hears what it sends itself; exactly those bytes are taken off, so nothing is lost",
                "Nothing has to be done; a switch or jumper of the adapter (local echo, receive enable) turns it off",
            ),
            Self::Collision => (
                "Something else came back than was sent",
                "Two stations sent at once: a second master is on the line, or a module answers too late",
                "Look for another program, controller or gateway that asks on the same line, and disconnect it",
            ),
            Self::Lost => (
                "Some answers do not come",
                "A bad contact, or a module that is busy or short of power: none of the missing answers came later",
                "Check terminals, power and the cable, then test again",
            ),
            Self::Late => (
                "Answers come too late",
                "The timeout is shorter than the module or a gateway on the way takes; a busy adapter, a USB hub or a \
                 virtual machine holds answers back; or two modules at one address answer one after the other",
                "Set a longer timeout, and a latency timer of 1 ms; connect the adapter without hub and virtual machine; \
                 the consistency test shows two modules at one address",
            ),
            Self::Stopped => (
                "It has stopped answering",
                "Its power or cable is gone, or its address or speed was changed",
                "Check its power and terminals; then scan for it",
            ),
            Self::CutShort => (
                "Answers end too early",
                "A bad contact, a module that loses power while it sends, or an adapter that switches its driver too early",
                "Check the terminals and the supply under load; try another adapter",
            ),
            Self::WrongAddress => (
                "Another module answers",
                "A late answer of another module, or two modules with mixed-up settings",
                "Ask the modules one by one, with the others switched off, and compare their addresses",
            ),
            Self::Refused => (
                "The module refused requests",
                "The line is fine. The module does not have what was asked, or not in this mode",
                "What needs INIT is changed in INIT mode only; a value out of range is refused; the traffic shows which \
                 request it was",
            ),
            Self::WatchdogTripped => (
                "The host watchdog has tripped",
                "The module heard no Host OK in time; its outputs hold their safe value and ignore commands",
                "Clear it: \"Clear the watchdog\" in the module's tab Host WDT, or `dcon-bench action clear_watchdog` (~AA1)",
            ),
            Self::NoPermission => (
                "The port may not be opened",
                if cfg!(windows) { "Another program has it open" } else { "Your user is not in the group of the port" },
                if cfg!(windows) {
                    "Close the program that has the port, and try again"
                } else {
                    "`sudo usermod -a -G dialout $USER`, then log out and in again"
                },
            ),
            Self::NoSuchPort => (
                "There is no such port",
                "The name is mistyped, or the adapter is not plugged in",
                "Choose one of the ports that are there (`dcon-bench ports` lists them)",
            ),
            Self::NoSerialPort => (
                "This is no serial port",
                "The name is that of something else",
                "Choose one of the ports that are there (`dcon-bench ports` lists them)",
            ),
            Self::ConnectionLost => (
                "The connection breaks off",
                "The module has no power or was restarted, the cable is out, or others use up its connections",
                "Check the module's power and the network's cables, and close other programs that are connected to it",
            ),
            Self::NotReached => (
                "The host cannot be reached",
                "The host or the port number is another one, the module has no power, or the cable is out",
                "Check the host's address (`ping`), the port number (502 unless it was changed), the cable and the \
                 module's power",
            ),
            Self::PortVanished => (
                "The port vanishes",
                if cfg!(target_os = "linux") {
                    "The adapter was pulled, or brltty (for braille displays) takes CH340 and CP210x adapters as soon as \
                     they are plugged in"
                } else {
                    "The adapter was pulled, has a bad contact, or lacks its driver"
                },
                if cfg!(target_os = "linux") {
                    "Plug it in again and look at `sudo dmesg`; if brltty is named there:"
                } else {
                    "Plug it in again at another USB port, without a hub; install the adapter's driver"
                },
            ),
            Self::PortBusy => (
                "The port is in use",
                "Another program holds it",
                if cfg!(target_os = "linux") {
                    "Close that program; `sudo fuser -v` with the port's name tells which it is"
                } else {
                    "Close that program, and try again"
                },
            ),
            Self::NotOpened => (
                "The line cannot be opened",
                "The adapter or its driver does not take the request",
                "Unplug the adapter and plug it in again",
            ),
            Self::SlowAdapter => (
                "The adapter holds answers back",
                "Its latency timer waits in case that more bytes come, 16 ms as adapters are sold; each answer is later by \
                 up to that",
                "Set the timer to 1 ms",
            ),
        }
    }
}

/// With a capital letter.
pub(super) fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

/// The likely reason of a Modbus exception.
pub fn exception_reason(code: u8) -> &'static str {
    match code {
        1 => "the module does not have this function, or not over this line",
        2 => "it does not have this register, or not in this mode",
        3 => "the value is out of range, or may be changed in INIT mode only",
        _ => "the module could not do it",
    }
}

/// The likely reason of a DCON `?AA`.
pub const DCON_REASON: &str = "the module does not have this command, its value is out of range, or it needs INIT mode";

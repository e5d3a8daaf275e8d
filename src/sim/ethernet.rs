//! What only the Ethernet and Wi-Fi sides of a PIR-234 have: settings that are kept and read back.

use super::refusal::Refusal;

/// Register 556 (PIR-234 manual 6.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ResetCause {
    PowerOn = 1,
    Software = 3,
}

/// Registers 272, 558, 559, 564 and 565. The two network watchdogs are kept but never bite.
#[derive(Debug, Clone)]
pub(super) struct Ethernet {
    /// The unit the module answers to over TCP. Factory value 1; here the address, so that several modules can
    /// stand behind one server.
    net_id: u8,
    host_timeout_s: u16,
    tcp_idle_s: u16,
    reset_timeout_s: u16,
    pub reset_cause: ResetCause,
}

impl Ethernet {
    pub fn new(net_id: u8) -> Self {
        Self { net_id, host_timeout_s: 0, tcp_idle_s: 180, reset_timeout_s: 0, reset_cause: ResetCause::PowerOn }
    }

    pub fn net_id(&self) -> u8 {
        self.net_id
    }

    pub fn set_net_id(&mut self, net_id: u16) -> Result<(), Refusal> {
        let net_id = Refusal::unless_within(net_id, 1..=247)?;
        self.net_id = u8::try_from(net_id).map_err(|_| Refusal::Value)?;
        Ok(())
    }

    pub fn host_timeout_s(&self) -> u16 {
        self.host_timeout_s
    }

    pub fn set_host_timeout(&mut self, seconds: u16) -> Result<(), Refusal> {
        self.host_timeout_s = zero_or_from(5, seconds)?;
        Ok(())
    }

    pub fn tcp_idle_s(&self) -> u16 {
        self.tcp_idle_s
    }

    pub fn set_tcp_idle(&mut self, seconds: u16) -> Result<(), Refusal> {
        self.tcp_idle_s = zero_or_from(5, seconds)?;
        Ok(())
    }

    pub fn reset_timeout_s(&self) -> u16 {
        self.reset_timeout_s
    }

    pub fn set_reset_timeout(&mut self, seconds: u16) -> Result<(), Refusal> {
        self.reset_timeout_s = zero_or_from(30, seconds)?;
        Ok(())
    }

    /// Coil 227: the default TCP settings of manual 3.5; the unit stays, or the module could not be found again.
    pub fn reload_defaults(&mut self) {
        *self = Self::new(self.net_id);
    }
}

fn zero_or_from(least: u16, seconds: u16) -> Result<u16, Refusal> {
    if seconds == 0 { Ok(0) } else { Refusal::unless_within(seconds, least..=u16::MAX) }
}

/// Registers 642 to 720 of the PIR-234-WF. What is written is read back at once, but rules only after 1 is written
/// to 715.
#[derive(Debug, Clone)]
pub(super) struct Wifi {
    written: [u16; WIFI_COUNT],
    in_force: [u16; WIFI_COUNT],
}

const WIFI_FIRST: u16 = 642;
const WIFI_COUNT: usize = 79;
/// "Write 1 to let the new Wi-Fi settings take effect."
const WIFI_APPLY: u16 = 715;

impl Wifi {
    /// The factory settings of manual 3.11.2. How texts and addresses lie in the registers is not documented: here the
    /// first byte is the high one.
    pub fn new() -> Self {
        let mut wifi = Self { written: [0; WIFI_COUNT], in_force: [0; WIFI_COUNT] };
        for (register, value) in [
            (642, 2),
            (643, 2),
            (683, 1),
            (710, 11),
            (711, 502),
            (716, 0xD05F),
            (717, 0xB81C),
            (718, 0x0C56),
            (719, 0x0100),
            (720, 0x0100),
        ] {
            wifi.put(register, value);
        }
        wifi.put_bytes(651, b"\x0800000000");
        wifi.put_bytes(684, &[192, 168, 255, 2]);
        wifi.put_bytes(688, &[192, 168, 255, 1]);
        wifi.put_bytes(690, &[255, 255, 0, 0]);
        wifi.put_bytes(692, &[192, 168, 255, 254]);
        wifi.put_bytes(694, b"PIR-234-WF");
        wifi.in_force = wifi.written;
        wifi
    }

    /// What was written last, or nothing if there is no such register.
    pub fn read(&self, register: u16) -> Option<u16> {
        self.written.get(index(register)?).copied()
    }

    /// What rules now.
    pub fn in_force(&self, register: u16) -> Option<u16> {
        self.in_force.get(index(register)?).copied()
    }

    /// Nothing if there is no such register to write.
    pub fn write(&mut self, register: u16, value: u16) -> Option<Result<(), Refusal>> {
        index(register).filter(|_| register < 716)?;
        let range = match register {
            642 if value == 1 => return Some(Err(Refusal::Value)),
            642 | 643 => 0..=2,
            683 | 687 | WIFI_APPLY => 0..=1,
            710 => 1..=11,
            711 => 1..=u16::MAX,
            _ => 0..=u16::MAX,
        };
        Some(Refusal::unless_within(value, range).map(|value| match register {
            WIFI_APPLY if value == 1 => self.in_force = self.written,
            WIFI_APPLY => (),
            _ => self.put(register, value),
        }))
    }

    fn put(&mut self, register: u16, value: u16) {
        if let Some(cell) = index(register).and_then(|index| self.written.get_mut(index)) {
            *cell = value;
        }
    }

    fn put_bytes(&mut self, first: u16, bytes: &[u8]) {
        for (register, pair) in (first..).zip(bytes.chunks(2)) {
            let high = pair.first().copied().unwrap_or_default();
            let low = pair.get(1).copied().unwrap_or_default();
            self.put(register, u16::from_be_bytes([high, low]));
        }
    }
}

/// The place of a register that the manual lists.
fn index(register: u16) -> Option<usize> {
    let listed = matches!(register, 642..=685 | 687..=711 | 715..=720);
    if listed { register.checked_sub(WIFI_FIRST).map(usize::from) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wifi_settings_rule_once_they_are_applied() {
        let mut wifi = Wifi::new();
        assert_eq!(wifi.write(710, 6), Some(Ok(())));
        assert_eq!((wifi.read(710), wifi.in_force(710)), (Some(6), Some(11)));
        assert_eq!(wifi.write(715, 1), Some(Ok(())));
        assert_eq!(wifi.in_force(710), Some(6));
    }

    #[test]
    fn wifi_registers_have_gaps_and_ranges() {
        let mut wifi = Wifi::new();
        for register in [0, 641, 686, 712, 714, 721, u16::MAX] {
            assert_eq!((wifi.read(register), wifi.write(register, 0)), (None, None), "{register}");
        }
        for (register, value) in [(642, 1), (643, 3), (683, 2), (710, 0), (710, 12), (711, 0), (715, 2)] {
            assert_eq!(wifi.write(register, value), Some(Err(Refusal::Value)), "{register}");
        }
        assert_eq!((wifi.read(720), wifi.write(720, 0)), (Some(0x0100), None));
        assert_eq!((wifi.read(684), wifi.read(685)), (Some(0xC0A8), Some(0xFF02)));
    }
}

//! How the switches of a module stand.

/// How the switches stand as far as the settings tell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SwitchPanel {
    pub banks: Vec<BankState>,
    pub rotary: Option<RotaryState>,
    /// What has to be known to read the panel, one sentence or two each.
    pub notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BankState {
    pub label: String,
    pub positions: Vec<PositionState>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PositionState {
    /// As printed on the switch, from 1.
    pub number: u8,
    /// The lowest number of the positions that mean something together with this one.
    pub group: u8,
    pub position: Position,
    /// Whether it counts as far as is known; if not, `position` is the one that would give the present settings.
    pub in_force: bool,
    /// `DIP 1 – Protocol`.
    pub title: String,
    /// What ON and OFF mean, and why it stands so; lines.
    pub explanation: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    On,
    Off,
    Unknown,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RotaryState {
    pub label: String,
    /// 0 to 15; `None` if it is not known.
    pub position: Option<u8>,
    pub in_force: bool,
    pub explanation: String,
}

impl SwitchPanel {
    /// Whether the module's definition describes no switches.
    pub fn is_empty(&self) -> bool {
        self.banks.is_empty() && self.rotary.is_none()
    }
}

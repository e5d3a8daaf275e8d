//! One question to one module and what can come back, the same for every protocol.

use super::{hex, modbus};

/// A question in the terms of its protocol. Coil and register addresses are those of the wire (0-based).
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Query {
    /// A DCON command, address included, without checksum and CR.
    Dcon {
        text: String,
        from: AnswerFrom,
        write: bool,
    },
    ReadCoils {
        first: u16,
        count: u16,
    },
    ReadHoldingRegisters {
        first: u16,
        count: u16,
    },
    ReadInputRegisters {
        first: u16,
        count: u16,
    },
    WriteCoil {
        at: u16,
        on: bool,
    },
    WriteCoils {
        first: u16,
        values: Vec<bool>,
    },
    WriteRegister {
        at: u16,
        value: u16,
    },
    WriteRegisters {
        first: u16,
        values: Vec<u16>,
    },
    /// A function outside the Modbus standard, such as 0x46.
    Custom {
        function: u8,
        data: Vec<u8>,
        write: bool,
    },
}

/// Who may answer a DCON command.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum AnswerFrom {
    /// The answer starts with one of these addresses.
    Addresses(Vec<u8>),
    /// The answer carries no address (`#AA` → `>(Data)`).
    Anyone,
    /// A broadcast: there is no answer to wait for.
    Nobody,
}

/// What a module answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reply {
    /// A DCON answer, delimiter first, without checksum.
    Text(String),
    Bits(Vec<bool>),
    Words(Vec<u16>),
    /// The data of a non-standard function's answer.
    Bytes(Vec<u8>),
    /// A write was acknowledged, or a broadcast was sent.
    Done,
}

/// Why there is no usable reply.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    #[error("no answer")]
    Silent,
    #[error("the module refused the command ({answer})")]
    Refused { answer: String },
    #[error("exception {code}: {}", modbus::exception_text(*.code))]
    Exception { code: u8 },
    #[error("the module ignored the command because its host watchdog has tripped; clear_watchdog lifts this")]
    Ignored,
    #[error("the answer was cut short after {}", hex::spaced(.bytes))]
    Cut { bytes: Vec<u8> },
    #[error("{reason} ({})", hex::spaced(.bytes))]
    Garbled { reason: String, bytes: Vec<u8> },
    #[error("what came back differs from what was sent ({}): two stations sent at once", hex::spaced(.bytes))]
    Collision { bytes: Vec<u8> },
    #[error("the answer {answer} has none of the known shapes")]
    UnknownShape { answer: String },
    #[error("{0}")]
    NotOffered(String),
    /// What had to come before it failed, so that the question did not leave.
    #[error("the module has not answered what it was asked before ({0})")]
    NotSent(Box<Failure>),
    #[error("the line was lost: {0}")]
    LineLost(String),
}

impl Failure {
    /// The module is there and said no: repeating the question brings nothing.
    pub fn is_refusal(&self) -> bool {
        matches!(self, Self::Refused { .. } | Self::Exception { .. } | Self::Ignored)
    }

    /// Some module answered, whatever it said.
    pub fn shows_presence(&self) -> bool {
        self.is_refusal() || matches!(self, Self::UnknownShape { .. })
    }

    /// The same for a question that was kept back because of it.
    pub fn kept_back(self) -> Self {
        match self {
            lost @ Self::LineLost(_) => lost,
            other => Self::NotSent(Box::new(other)),
        }
    }

    /// What happened on the line.
    pub fn root(&self) -> &Self {
        match self {
            Self::NotSent(before) => before.root(),
            other => other,
        }
    }

    /// Bytes arrived that make no sense.
    pub fn is_garbage(&self) -> bool {
        matches!(self, Self::Cut { .. } | Self::Garbled { .. } | Self::Collision { .. })
    }
}

impl Query {
    /// Whether the question changes something in the module.
    pub fn is_write(&self) -> bool {
        match self {
            Self::Dcon { write, .. } | Self::Custom { write, .. } => *write,
            Self::ReadCoils { .. } | Self::ReadHoldingRegisters { .. } | Self::ReadInputRegisters { .. } => false,
            Self::WriteCoil { .. }
            | Self::WriteCoils { .. }
            | Self::WriteRegister { .. }
            | Self::WriteRegisters { .. } => true,
        }
    }
}

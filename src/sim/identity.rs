//! What a module says it is.

use super::spec::Model;

/// Names and firmware in the shapes of both protocols.
pub(super) struct Identity {
    /// After `$AAM`.
    pub dcon_name: &'static str,
    /// After `$AAF`.
    pub dcon_firmware: &'static str,
    /// Registers 483 (low word) and 484 (high word).
    pub name: [u16; 2],
    /// Registers 481 (low word) and 482 (high word).
    pub firmware: [u16; 2],
}

/// The PIR-130's register values are not printed: its name is that of function 0x46 (manual 3.10.1), and the
/// firmware word follows the 01.00 of manual 2.5. The PIR-230's are inferred from its sister.
pub(super) fn of(model: Model) -> &'static Identity {
    match model {
        Model::Pir130 => &Identity {
            dcon_name: "PIR130",
            dcon_firmware: "01.00",
            name: [0x0101, 0x4C43],
            firmware: [0x0100, 0x0000],
        },
        Model::Pir230 => {
            &Identity { dcon_name: "PIR230E", dcon_firmware: "B2.8", name: [0x0230, 0x5049], firmware: [0x0B28, 0] }
        }
        Model::Pir234 | Model::Pir234Wf => {
            &Identity { dcon_name: "PIR234", dcon_firmware: "B2.8", name: [0x0234, 0x5049], firmware: [0x0B28, 0] }
        }
        Model::Unknown => &Identity { dcon_name: "7065", dcon_firmware: "", name: [0, 0], firmware: [0, 0] },
    }
}

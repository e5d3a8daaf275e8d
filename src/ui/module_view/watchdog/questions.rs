//! What is asked before the host watchdog can act on the relays.

use std::time::Duration;

use crate::bench::{Action, HostOk, Module};
use crate::module::Value;
use crate::ui::guard::Confirm;

/// The question before these changes are written: enabling the watchdog while nothing here feeds it in time, or
/// shortening its timeout below the period of Host OK.
pub fn before_writing(module: &Module, ids: &[String]) -> Option<Confirm> {
    let writes = |id: &str| ids.iter().any(|written| written == id);
    let after = |id: &str| if writes(id) { module.wanted(id) } else { module.known(id) };
    let enabling = writes("wdt_enabled") && !module.watchdog_counts();
    let enabled = after("wdt_enabled").and_then(Value::as_bool).unwrap_or(false);
    if !enabled || !(enabling || writes("wdt_timeout")) {
        return None;
    }
    let timeout = after("wdt_timeout").and_then(Value::as_f64);
    let reason = match &module.host_ok {
        None if enabling => "Nothing here sends Host OK at present.".to_owned(),
        Some(host_ok) if timeout.is_some_and(|timeout| host_ok.period.as_secs_f64() > timeout) => {
            format!("Host OK is sent every {} here, which is too late.", seconds(host_ok.period))
        }
        _ => return None,
    };
    let after = timeout.map_or_else(|| "After its timeout".to_owned(), |timeout| format!("In {timeout:.1} s"));
    Some(Confirm {
        title: format!("Host watchdog of {} at address {}", module.label(), module.target.address),
        lines: vec![
            format!("{after} the relays go to their safe values unless a host sends Host OK{}.", safe_values(module)),
            reason,
        ],
        button: if enabling { "Enable watchdog".to_owned() } else { format!("Write {}", ids.len()) },
        actions: vec![Action::Write(module.target, ids.to_vec())],
    })
}

/// The question before Host OK stops; none while the watchdog would not notice.
pub fn before_stopping(module: &Module) -> Option<Confirm> {
    if module.host_ok.is_none() || !module.watchdog_counts() {
        return None;
    }
    let after = module.watchdog_timeout().map_or_else(|| "Its timeout".to_owned(), seconds);
    Some(Confirm {
        title: format!("Stop Host OK for {} at address {}", module.label(), module.target.address),
        lines: vec![
            format!("{after} after the last Host OK its host watchdog trips{}.", safe_values(module)),
            "The relays go to their safe values and stay there until the watchdog is cleared.".to_owned(),
        ],
        button: "Stop Host OK now".to_owned(),
        actions: vec![Action::StopHostOk(module.target)],
    })
}

/// `: DO0 off, DO1 on`, as far as the safe values are known.
pub fn safe_values(module: &Module) -> String {
    let items = module.definition().into_iter().flat_map(|definition| &definition.items);
    let known = items.filter_map(|item| {
        let output = module.item(item.id.strip_suffix("_safe")?)?;
        Some(format!("{} {}", output.label, item.bare_text(module.known(&item.id)?)))
    });
    let known: Vec<String> = known.collect();
    if known.is_empty() { String::new() } else { format!(": {}", known.join(", ")) }
}

/// `1.7 s`; two decimals below a tenth.
pub fn seconds(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    if seconds > 0.0 && seconds < 0.1 { format!("{seconds:.2} s") } else { format!("{seconds:.1} s") }
}

/// `Host OK every 1.7 s`.
pub fn period_words(host_ok: &HostOk) -> String {
    format!("Host OK every {}", seconds(host_ok.period))
}

//! One zip with everything that helps somebody else to help.

use std::io::{self, Cursor, Write};
use std::ops::Range;
use std::path::Path;

use jiff::Timestamp;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{Report, adapter_in_words};
use crate::bus::{Frame, PortInfo};
use crate::capture::{CaptureWriter, Form};
use crate::folders;
use crate::record::write_whole;

/// Frames of traffic that a bundle holds at most.
pub const MOST_FRAMES: u64 = 20_000;
/// The names of the traffic's parts.
const TRAFFIC_CSV: &str = "traffic.csv";
const TRAFFIC_PCAPNG: &str = "traffic.pcapng";

/// Of the frames with these numbers, the last ones that a bundle holds.
pub fn last_frames(frames: Range<u64>) -> Range<u64> {
    frames.end.saturating_sub(MOST_FRAMES).max(frames.start)..frames.end
}

/// The traffic of a bundle in both forms, gathered frame by frame.
pub struct Traffic {
    /// The lines of a CSV file, its column names first.
    pub csv: Vec<u8>,
    capture: CaptureWriter<Vec<u8>>,
}

impl Traffic {
    /// Begins the traffic of the line of this name.
    ///
    /// # Errors
    /// If the capture cannot be begun.
    pub fn new(line: &str) -> io::Result<Self> {
        Ok(Self { csv: Vec::new(), capture: CaptureWriter::new(Form::Pcapng, Vec::new(), line)? })
    }

    /// Adds a frame to the capture; its line of CSV is the caller's.
    ///
    /// # Errors
    /// If the frame cannot be written.
    pub fn frame(&mut self, frame: &Frame) -> io::Result<()> {
        self.capture.frame(frame)
    }

    fn into_parts(self) -> io::Result<Vec<Part>> {
        Ok(vec![Part::new(TRAFFIC_CSV, self.csv), Part::new(TRAFFIC_PCAPNG, self.capture.finish()?)])
    }
}

/// One file in the bundle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// With its ending; no folder.
    pub name: String,
    pub bytes: Vec<u8>,
}

impl Part {
    pub fn new(name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.to_owned(), bytes: bytes.into() }
    }
}

/// What goes into a bundle.
#[derive(Debug, Clone, PartialEq)]
pub struct Bundle {
    pub report: Report,
    pub ports: Vec<PortInfo>,
    /// The text of the settings file, if there is one.
    pub settings: Option<String>,
    /// How the program was started: its arguments, the program's name first.
    pub command: Vec<String>,
    /// Further files, such as the last traffic.
    pub parts: Vec<Part>,
}

/// Everything that helps, with the settings file of this computer's user.
///
/// # Errors
/// If the traffic cannot be ended.
pub fn gather(report: Report, ports: Vec<PortInfo>, traffic: Traffic) -> io::Result<Bundle> {
    let settings = folders::config().and_then(|folder| std::fs::read_to_string(folder.join("settings.toml")).ok());
    let command = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    Ok(Bundle { report, ports, settings, command, parts: traffic.into_parts()? })
}

const README: &str = "\
What is in this file

report.txt      what was found on the line, for people
report.json     the same for programs
setup.txt       line, timeout, repeats and the adapter's latency timer; how the program was started
versions.txt    program and operating system
ports.json      the serial ports of the computer
settings.toml   the settings of the program, if there are any
traffic.csv     the last bytes that were sent and received on the line, with their times
traffic.pcapng  the same for Wireshark

Before you pass it on

The traffic holds everything that was sent to the modules and what they answered. If Wi-Fi settings were read or written
meanwhile, the key of that network can be read in it. The settings name ports, hosts and folders of this computer. Look
through the files, and take out of the zip what others should not see.
";

impl Bundle {
    /// The zip as bytes.
    ///
    /// # Errors
    /// What the zip's writer says.
    pub fn to_bytes(&self) -> io::Result<Vec<u8>> {
        let time = self.report.made_at.to_zoned(jiff::tz::TimeZone::UTC).datetime();
        let time = DateTime::try_from(time).unwrap_or_default();
        let options =
            SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).last_modified_time(time);
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for part in self.own_parts()?.iter().chain(&self.parts) {
            zip.start_file(part.name.as_str(), options)?;
            zip.write_all(&part.bytes)?;
        }
        Ok(zip.finish()?.into_inner())
    }

    /// Writes it as a whole: the file has its name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let bytes = self.to_bytes()?;
        write_whole(path, |mut file| file.write_all(&bytes))
    }

    fn own_parts(&self) -> io::Result<Vec<Part>> {
        let mut parts = vec![
            Part::new("README.txt", README),
            Part::new("report.txt", self.report.to_string()),
            Part::new("report.json", serde_json::to_vec_pretty(&self.report)?),
            Part::new("setup.txt", setup(&self.report, &self.command)),
            Part::new("versions.txt", versions(&self.report.program, self.report.made_at)),
            Part::new("ports.json", serde_json::to_vec_pretty(&self.ports)?),
        ];
        parts.extend(self.settings.as_deref().map(|text| Part::new("settings.toml", text)));
        Ok(parts)
    }
}

fn setup(report: &Report, command: &[String]) -> String {
    let line = &report.line;
    let latency = line.adapter.as_ref().map_or_else(|| "none is known of".to_owned(), adapter_in_words);
    let rows = [
        ("line", line.name.clone()),
        ("timeout", format!("{} ms", line.timeout_ms)),
        ("repeats", line.repeats.to_string()),
        ("latency timer", latency),
        ("command line", without_secrets(command)),
    ];
    rows.iter().map(|(name, text)| format!("{name:<14} {text}\n")).collect()
}

/// The command line as it would be typed, without the program's folder and without what nobody else should know: values
/// whose names sound like keys or passwords, and what stands before the @ of a host.
fn without_secrets(command: &[String]) -> String {
    let Some((program, words)) = command.split_first() else { return String::new() };
    let name = Path::new(program).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut told = vec![name];
    let mut hide_next = false;
    for word in words {
        let hidden = std::mem::replace(&mut hide_next, word.starts_with("--") && sounds_secret(word));
        told.push(if hidden { HIDDEN.to_owned() } else { typed(&without_secret(word)) });
    }
    told.join(" ")
}

/// Stands where something was left out.
const HIDDEN: &str = "…";

fn sounds_secret(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["key", "pass", "secret", "token", "psk"].iter().any(|part| name.contains(part))
}

fn without_secret(word: &str) -> String {
    match (word.split_once('='), word.rsplit_once('@')) {
        (Some((name, _)), _) if sounds_secret(name) => format!("{name}={HIDDEN}"),
        (_, Some((before, host))) if before.contains(':') => format!("{HIDDEN}@{host}"),
        _ => word.to_owned(),
    }
}

fn typed(word: &str) -> String {
    if word.is_empty() || word.contains([' ', '"', '\'']) { format!("{word:?}") } else { word.to_owned() }
}

fn versions(program: &str, at: Timestamp) -> String {
    let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
    // Where Linux tells which distribution it is.
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let name = release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME=")).unwrap_or_default().trim_matches('"');
    let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    let more =
        [name, kernel.trim()].map(|text| if text.is_empty() { String::new() } else { format!(", {text}") }).concat();
    format!("{program}\n{system} {processor}{more}\nmade at {at:.0}\n")
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;
    use crate::diagnosis::Diagnosis;

    #[test]
    fn a_bundle_is_a_zip_that_tells_what_is_in_it_and_what_to_look_out_for() {
        let report = Diagnosis::default().report(Timestamp::UNIX_EPOCH, "COM3", |_| None);
        let settings = Some("theme = \"dark\"\n".to_owned());
        let mut traffic = Traffic::new("COM3").unwrap();
        traffic.csv.extend(b"time\n");
        let parts = traffic.into_parts().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("help.zip");
        let command = ["/usr/bin/dcon-bench", "diagnose", "--port", "COM3"].map(str::to_owned).to_vec();
        Bundle { report, ports: Vec::new(), settings, command, parts }.write(&path).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no part is left");
        let mut zip = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
        let names: Vec<String> = zip.file_names().map(|name| name.unwrap().into_owned()).collect();
        assert_eq!(
            names,
            [
                "README.txt",
                "report.txt",
                "report.json",
                "setup.txt",
                "versions.txt",
                "ports.json",
                "settings.toml",
                "traffic.csv",
                "traffic.pcapng"
            ]
        );
        let mut text = |name: &str| {
            let mut text = String::new();
            zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
            text
        };
        assert!(text("README.txt").contains("Wi-Fi"));
        let setup = text("setup.txt");
        for row in
            ["timeout        200 ms", "repeats        2", "latency timer  none", "dcon-bench diagnose --port COM3"]
        {
            assert!(setup.contains(row), "{row}\n{setup}");
        }
        assert!(text("versions.txt").contains(env!("CARGO_PKG_VERSION")));
        assert_eq!(text("settings.toml"), "theme = \"dark\"\n");
        let json: serde_json::Value = serde_json::from_str(&text("report.json")).unwrap();
        assert_eq!(json["line"]["name"], "COM3");
    }

    #[test]
    fn the_command_line_is_told_without_secrets() {
        let told = |words: &[&str]| without_secrets(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        assert_eq!(
            told(&["C:/x/dcon-bench.exe", "set", "wifi_key=abc", "name=a b"]),
            "dcon-bench set wifi_key=… \"name=a b\""
        );
        assert_eq!(told(&["dcon-bench", "--tcp", "me:hidden@host:502"]), "dcon-bench --tcp …@host:502");
        assert_eq!(told(&["dcon-bench", "--password", "abc", "x"]), "dcon-bench --password … x");
        assert_eq!(told(&[]), "");
    }
}

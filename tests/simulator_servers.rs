//! The simulated world as a serial port and as a Modbus TCP server.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use dcon_bench::sim::{Pace, Sim, TcpServer};

fn world(specs: &[&str]) -> Sim {
    let specs: Vec<_> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
    Sim::new(&specs, Pace::Real)
}

fn ask(stream: &mut TcpStream, unit: u8, pdu: &[u8]) -> std::io::Result<Vec<u8>> {
    let length = u16::try_from(pdu.len() + 1).unwrap().to_be_bytes();
    stream.write_all(&[&[0, 7, 0, 0], length.as_slice(), &[unit], pdu].concat())?;
    let mut head = [0; 7];
    stream.read_exact(&mut head)?;
    assert_eq!((&head[..4], head[6]), (&[0, 7, 0, 0][..], unit));
    let mut answer = vec![0; usize::from(u16::from_be_bytes([head[4], head[5]])) - 1];
    stream.read_exact(&mut answer)?;
    Ok(answer)
}

fn client(server: &TcpServer) -> TcpStream {
    let stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(300))).unwrap();
    stream
}

fn any_port() -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], 0))
}

#[test]
fn modbus_tcp_reaches_the_modules_that_have_ethernet() {
    let sim = world(&["pir-234@1", "pir-230@0xA3:dcon", "pir-130@2"]);
    let server = TcpServer::bind(&sim, any_port()).unwrap();
    let mut stream = client(&server);
    assert_eq!(ask(&mut stream, 1, &[3, 1, 0xE2, 0, 2]).unwrap(), [3, 4, 0x02, 0x34, 0x50, 0x49]);
    assert_eq!(ask(&mut stream, 0xA3, &[3, 2, 0x2F, 0, 1]).unwrap(), [3, 2, 0x02, 0x30]);
    assert_eq!(ask(&mut stream, 1, &[16, 0, 0xE1, 0, 1, 2, 0x0B, 0xB8]).unwrap(), [16, 0, 0xE1, 0, 1]);
    assert_eq!(sim.setting(1, "alarm_limit").as_deref(), Some("30.00"));
    assert!(ask(&mut stream, 2, &[3, 1, 0xE2, 0, 2]).is_err(), "a PIR-130 has no Ethernet");
}

#[test]
fn each_side_has_registers_of_its_own() {
    let sim = world(&["pir-234@1"]);
    let server = TcpServer::bind(&sim, any_port()).unwrap();
    let mut stream = client(&server);
    for number in [485_u16, 486, 488, 489, 492] {
        let [high, low] = (number - 1).to_be_bytes();
        assert_eq!(ask(&mut stream, 1, &[3, high, low, 0, 1]).unwrap(), [0x83, 2], "register {number}");
    }
    for coil in [257_u16, 261, 270, 273] {
        let [high, low] = (coil - 1).to_be_bytes();
        assert_eq!(ask(&mut stream, 1, &[1, high, low, 0, 1]).unwrap(), [0x81, 2], "coil {coil}");
    }
    for (number, value) in
        [(272_u16, 1_u16), (352, 0x0B28), (556, 1), (558, 0), (559, 0), (560, 0x0234), (564, 180), (565, 0)]
    {
        let ([high, low], value) = ((number - 1).to_be_bytes(), value.to_be_bytes());
        assert_eq!(
            ask(&mut stream, 1, &[3, high, low, 0, 1]).unwrap(),
            [3, 2, value[0], value[1]],
            "register {number}"
        );
    }
}

#[test]
fn a_reboot_over_ethernet_is_told_as_the_reset_cause() {
    let sim = world(&["pir-234@1"]);
    let server = TcpServer::bind(&sim, any_port()).unwrap();
    let mut stream = client(&server);
    assert_eq!(ask(&mut stream, 1, &[6, 2, 0x33, 0, 29]).unwrap(), [6, 2, 0x33, 0, 29]);
    assert_eq!(ask(&mut stream, 1, &[6, 2, 0x34, 0, 29]).unwrap(), [0x86, 3]);
    assert_eq!(ask(&mut stream, 1, &[5, 0, 233, 0xFF, 0]).unwrap(), [5, 0, 233, 0xFF, 0]);
    assert_eq!(ask(&mut stream, 1, &[3, 2, 0x2B, 0, 1]).unwrap(), [3, 2, 0, 3]);
    assert_eq!(sim.setting(1, "tcp_idle_timeout").as_deref(), Some("29"));
    assert_eq!(ask(&mut stream, 1, &[5, 0, 226, 0xFF, 0]).unwrap(), [5, 0, 226, 0xFF, 0]);
    assert_eq!(sim.setting(1, "tcp_idle_timeout").as_deref(), Some("180"));
}

#[test]
fn a_malformed_request_costs_its_sender_the_connection_and_nobody_else() {
    let sim = world(&["pir-234@1"]);
    let server = TcpServer::bind(&sim, any_port()).unwrap();
    let mut good = client(&server);
    for pdu in
        [&[16, 2, 0, 0x80, 1, 2, 0, 1][..], &[15, 0, 0, 0xFF, 0xFF, 1, 1], &[3, 0], &[5, 0, 0, 1, 2], &[0xFF], &[]]
    {
        assert!(ask(&mut client(&server), 1, pdu).is_err(), "{pdu:02X?}");
        assert!(ask(&mut good, 1, &[4, 0, 0, 0, 5]).is_ok(), "{pdu:02X?}");
    }
}

#[test]
fn a_dropped_server_frees_its_port() {
    let sim = world(&["pir-234@1"]);
    let server = TcpServer::bind(&sim, any_port()).unwrap();
    let mut stream = client(&server);
    assert!(ask(&mut stream, 1, &[4, 0, 0, 0, 5]).is_ok());
    let address = server.address();
    drop(server);
    assert!(TcpStream::connect(address).is_err());
}

#[cfg(unix)]
mod pseudo_terminal {
    use std::fs::{File, OpenOptions};
    use std::path::Path;
    use std::time::Instant;

    use dcon_bench::sim::PtyServer;
    use rustix::termios::{OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};

    use super::*;

    /// Opens the port as a serial program does, at a speed.
    fn open(path: &Path, bps: u32) -> File {
        let port = OpenOptions::new().read(true).write(true).open(path).unwrap();
        let mut settings = tcgetattr(&port).unwrap();
        settings.make_raw();
        settings.set_speed(bps).unwrap();
        // A read returns what there is, or nothing after half a second.
        settings.special_codes[SpecialCodeIndex::VMIN] = 0;
        settings.special_codes[SpecialCodeIndex::VTIME] = 5;
        tcsetattr(&port, OptionalActions::Now, &settings).unwrap();
        port
    }

    /// What comes until `end` bytes or half a second of silence.
    fn ask(mut port: &File, request: &[u8], end: usize) -> Vec<u8> {
        port.write_all(request).unwrap();
        let mut answer = vec![0; end];
        let mut count = 0;
        while count < end {
            match port.read(&mut answer[count..]).unwrap() {
                0 => break,
                more => count += more,
            }
        }
        answer.truncate(count);
        answer
    }

    #[test]
    fn a_program_talks_to_modules_of_both_protocols() {
        let sim = world(&["pir-234@1", "pir-130@2:dcon"]);
        let server = PtyServer::open(&sim, None).unwrap();
        let port = open(server.path(), 9600);
        let start = Instant::now();
        let request = [0x01, 0x03, 0x01, 0xE0, 0x00, 0x04, 0x44, 0x03];
        assert_eq!(ask(&port, &request, 13)[3..11], [0x0B, 0x28, 0, 0, 0x02, 0x34, 0x50, 0x49]);
        assert!(start.elapsed() >= Duration::from_millis(21 + 5), "at the speed of a wire");
        drop(port);
        let port = open(server.path(), 9600);
        assert_eq!(ask(&port, b"$02M\r", 10), b"!02PIR130\r");
        assert_eq!(sim.requests(), 2);
    }

    #[test]
    fn a_module_does_not_hear_another_speed() {
        let sim = world(&["pir-130@2:dcon:19200"]);
        let server = PtyServer::open(&sim, None).unwrap();
        assert_eq!(ask(&open(server.path(), 9600), b"$02M\r", 10), b"");
        assert_eq!(ask(&open(server.path(), 19_200), b"$02M\r", 10), b"!02PIR130\r");
    }

    #[test]
    fn what_is_no_request_ends_with_a_silence() {
        let sim = world(&["pir-130@2:dcon"]);
        let server = PtyServer::open(&sim, None).unwrap();
        assert_eq!(ask(&open(server.path(), 9600), b"\x00garbage", 1), b"");
        assert_eq!(ask(&open(server.path(), 9600), b"$02M\r", 10), b"!02PIR130\r");
    }

    #[test]
    fn a_link_leads_to_the_terminal_and_goes_with_the_server() {
        let sim = world(&["pir-130@2:dcon"]);
        let directory = std::env::temp_dir().join(format!("simulator-link-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let link = directory.join("port");
        let server = PtyServer::open(&sim, Some(&link)).unwrap();
        assert_eq!(std::fs::read_link(&link).unwrap(), server.path());
        let second = PtyServer::open(&sim, Some(&link)).unwrap();
        assert_eq!(std::fs::read_link(&link).unwrap(), second.path());
        drop(server);
        assert!(link.exists(), "it is the second server's by now");
        drop(second);
        assert!(!link.exists());
        std::fs::write(&link, "someone's file").unwrap();
        assert!(PtyServer::open(&sim, Some(&link)).is_err());
        std::fs::remove_dir_all(&directory).unwrap();
    }
}

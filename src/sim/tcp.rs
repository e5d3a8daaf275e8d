//! The Ethernet side of the PIR-234 modules: Modbus TCP, one unit identifier for each.

use std::future::{Ready, ready};
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;

use tokio::sync::oneshot;
use tokio_modbus::bytes::Bytes;
use tokio_modbus::server::Service;
use tokio_modbus::server::tcp::Server;
use tokio_modbus::{ExceptionCode, Request, Response, SlaveRequest};

use super::handle::Sim;

/// As many clients as one module serves at a time.
const MOST_CLIENTS: usize = 32;

/// Serves the PIR-230 and PIR-234 modules of a simulated world over Modbus TCP until dropped.
///
/// The unit identifier is the module's net id, which is its RS-485 address until register 272 is written. Other units
/// stay silent.
#[derive(Debug)]
pub struct TcpServer {
    address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl TcpServer {
    /// Listens at `address`; port 0 takes any free one.
    pub fn bind(sim: &Sim, address: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        let listener = {
            let _context = runtime.enter();
            tokio::net::TcpListener::from_std(listener)?
        };
        let (stop, stopped) = oneshot::channel();
        let units = Units { sim: sim.clone(), seat: Arc::new(()) };
        let thread = std::thread::Builder::new().name("sim-tcp".to_owned()).spawn(move || {
            if let Err(error) = runtime.block_on(serve(listener, units, stopped)) {
                log::error!("simulated Ethernet: {error}");
            }
        })?;
        Ok(Self { address, stop: Some(stop), thread: Some(thread) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for TcpServer {
    fn drop(&mut self) {
        // Dropping the sender is the signal.
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // It has logged its own failure.
            let _ = thread.join();
        }
    }
}

async fn serve(listener: tokio::net::TcpListener, units: Units, stopped: oneshot::Receiver<()>) -> io::Result<()> {
    let on_connected = |stream, client| {
        let full = Arc::strong_count(&units.seat) > MOST_CLIENTS;
        if full {
            log::warn!("simulated Ethernet: {client} turned away, {MOST_CLIENTS} clients are connected");
        }
        ready(Ok((!full).then(|| (units.clone(), stream))))
    };
    let on_error = |error| log::debug!("simulated Ethernet: {error}");
    let until = async {
        let _ = stopped.await;
    };
    Server::new(listener).serve_until(&on_connected, on_error, until).await.map(|_| ())
}

/// All units behind the server, as one client sees them.
#[derive(Clone)]
struct Units {
    sim: Sim,
    /// Its copies are counted: the server has one, each client another.
    seat: Arc<()>,
}

impl Service for Units {
    type Request = SlaveRequest<'static>;
    type Response = Option<Response>;
    type Exception = ExceptionCode;
    type Future = Ready<Result<Self::Response, Self::Exception>>;

    fn call(&self, request: Self::Request) -> Self::Future {
        let answer = self.sim.world().hear_tcp(request.slave, &pdu(&request.request));
        // The module's own words, exceptions included, pass through as they are.
        ready(Ok(answer.and_then(|answer| {
            let (&function, data) = answer.split_first()?;
            Some(Response::Custom(function, Bytes::copy_from_slice(data)))
        })))
    }
}

/// Function code and data, as they came. What no module supports is passed on without its data.
fn pdu(request: &Request<'_>) -> Vec<u8> {
    let words = |words: &[u16]| words.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<u8>>();
    let data = match request {
        Request::ReadCoils(first, count)
        | Request::ReadDiscreteInputs(first, count)
        | Request::ReadHoldingRegisters(first, count)
        | Request::ReadInputRegisters(first, count) => words(&[*first, *count]),
        Request::WriteSingleCoil(number, on) => words(&[*number, if *on { 0xFF00 } else { 0x0000 }]),
        Request::WriteSingleRegister(number, value) => words(&[*number, *value]),
        Request::WriteMultipleCoils(first, bits) => several(*first, bits.len(), packed(bits)),
        Request::WriteMultipleRegisters(first, values) => several(*first, values.len(), words(values)),
        Request::Custom(_, data) => data.to_vec(),
        _ => Vec::new(),
    };
    [&[request.function_code().value()], data.as_slice()].concat()
}

/// The data of a request that writes several: first, count, byte count, values. One request holds fewer than 2000
/// bits, so nothing is cut off.
fn several(first: u16, count: usize, values: Vec<u8>) -> Vec<u8> {
    let head = [first.to_be_bytes(), (count as u16).to_be_bytes()].concat();
    [head, vec![values.len() as u8], values].concat()
}

fn packed(bits: &[bool]) -> Vec<u8> {
    let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit));
    bits.chunks(8).map(byte).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_passed_on_as_it_came() {
        for (request, expected) in [
            (Request::ReadInputRegisters(0, 5), vec![4, 0, 0, 0, 5]),
            (Request::WriteSingleCoil(1, true), vec![5, 0, 1, 0xFF, 0]),
            (Request::WriteMultipleCoils(0, vec![true, false, true].into()), vec![15, 0, 0, 0, 3, 1, 0b101]),
            (Request::WriteMultipleRegisters(512, vec![10, 258].into()), vec![16, 2, 0, 0, 2, 4, 0, 10, 1, 2]),
            (Request::Custom(0x46, vec![0x20].into()), vec![0x46, 0x20]),
            (Request::ReportServerId, vec![17]),
        ] {
            assert_eq!(pdu(&request), expected);
        }
    }
}

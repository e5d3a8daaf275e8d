//! Queries to Modbus frames and back, through `tokio-modbus`.
//!
//! For each transaction a fresh client is set on one end of a pipe in memory. What it writes to the other end is the
//! request; it is given one whole, verified answer and nothing else, so none of its own framing ever matters.

use std::io;

use tokio::io::{AsyncReadExt, AsyncWriteExt, duplex};
use tokio::runtime::Runtime;
use tokio_modbus::client::{Client, rtu};
use tokio_modbus::{Request, Response, Slave};

use crate::protocol::{Failure, Query, Reply};

/// Larger than the longest Modbus frame.
const PIPE: usize = 512;

/// Encodes `query` for the slave `unit`, lets `exchange` turn the frame into an answer, and decodes that.
pub fn transact(
    runtime: &Runtime,
    unit: u8,
    query: &Query,
    mut exchange: impl FnMut(&[u8]) -> Result<Vec<u8>, Failure>,
) -> Result<Reply, Failure> {
    let request = request_of(query)?;
    let mut failure = None;
    let answered = runtime.block_on(async {
        let (client_end, mut wire_end) = duplex(PIPE);
        let mut client = rtu::attach_slave(client_end, Slave(unit));
        let serve = async {
            let mut frame = [0; PIPE];
            let count = wire_end.read(&mut frame).await?;
            match exchange(frame.get(..count).unwrap_or_default()) {
                Ok(answer) => wire_end.write_all(&answer).await?,
                Err(error) => failure = Some(error),
            }
            drop(wire_end);
            io::Result::Ok(())
        };
        let (answered, _served) = tokio::join!(client.call(request), serve);
        answered
    });
    match failure {
        Some(failure) => Err(failure),
        None => reply_of(query, answered),
    }
}

/// The request in `tokio-modbus`' words.
pub fn request_of(query: &Query) -> Result<Request<'static>, Failure> {
    Ok(match query.clone() {
        Query::Dcon { text, .. } => return Err(Failure::NotOffered(format!("{text} is not a Modbus request"))),
        Query::ReadCoils { first, count } => Request::ReadCoils(first, count),
        Query::ReadHoldingRegisters { first, count } => Request::ReadHoldingRegisters(first, count),
        Query::ReadInputRegisters { first, count } => Request::ReadInputRegisters(first, count),
        Query::WriteCoil { at, on } => Request::WriteSingleCoil(at, on),
        Query::WriteCoils { first, values } => Request::WriteMultipleCoils(first, values.into()),
        Query::WriteRegister { at, value } => Request::WriteSingleRegister(at, value),
        Query::WriteRegisters { first, values } => Request::WriteMultipleRegisters(first, values.into()),
        Query::Custom { function, data, .. } => Request::Custom(function, data.into()),
    })
}

/// What `tokio-modbus` made of the answer. The lengths are checked here: it trusts the answer's own byte count.
pub fn reply_of(query: &Query, answered: tokio_modbus::Result<Response>) -> Result<Reply, Failure> {
    let unusable = |reason: String| Failure::Garbled { reason, bytes: Vec::new() };
    let response = match answered {
        Ok(Ok(response)) => response,
        Ok(Err(exception)) => return Err(Failure::Exception { code: exception.into() }),
        Err(error) => return Err(unusable(format!("the answer cannot be decoded: {error}"))),
    };
    match (query, response) {
        (Query::ReadCoils { count, .. }, Response::ReadCoils(mut bits)) if bits.len() >= usize::from(*count) => {
            bits.truncate(usize::from(*count));
            Ok(Reply::Bits(bits))
        }
        (Query::ReadHoldingRegisters { count, .. }, Response::ReadHoldingRegisters(words))
        | (Query::ReadInputRegisters { count, .. }, Response::ReadInputRegisters(words))
            if words.len() == usize::from(*count) =>
        {
            Ok(Reply::Words(words))
        }
        (Query::Custom { .. }, Response::Custom(_, bytes)) => Ok(Reply::Bytes(bytes.to_vec())),
        (query, _) if query.is_write() => Ok(Reply::Done),
        (_, other) => Err(unusable(format!("an unexpected answer: {other:?}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::{hex, modbus};

    fn runtime() -> Runtime {
        tokio::runtime::Builder::new_current_thread().build().unwrap()
    }

    fn ask(query: &Query, answer: &str) -> (String, Result<Reply, Failure>) {
        let mut sent = Vec::new();
        let reply = transact(&runtime(), 1, query, |request| {
            sent = request.to_vec();
            Ok(hex::parse(answer).unwrap())
        });
        (hex::spaced(&sent), reply)
    }

    #[test]
    fn published_requests_are_encoded_and_their_answers_decoded() {
        let inputs = Query::ReadInputRegisters { first: 0, count: 5 };
        let (sent, reply) = ask(&inputs, "01 04 0A 0B B8 21 98 13 88 06 40 0F 28 CE 8C");
        assert_eq!(sent, "01 04 00 00 00 05 30 09");
        assert_eq!(reply, Ok(Reply::Words(vec![3000, 8600, 5000, 1600, 3880])));
        let (sent, reply) = ask(&Query::WriteCoil { at: 0, on: true }, "01 05 00 00 FF 00 8C 3A");
        assert_eq!((sent.as_str(), reply), ("01 05 00 00 FF 00 8C 3A", Ok(Reply::Done)));
    }

    #[test]
    fn function_46_and_its_refusal_pass_through() {
        let name = Query::Custom { function: 0x46, data: vec![0], write: false };
        let (sent, reply) = ask(&name, "01 46 00 54 20 26 00 0E FC");
        assert_eq!(sent, "01 46 00 12 60");
        assert_eq!(reply, Ok(Reply::Bytes(vec![0, 0x54, 0x20, 0x26, 0])));
        assert_eq!(ask(&name, "01 C6 02 F2 61").1, Err(Failure::Exception { code: 2 }));
    }

    #[test]
    fn an_answer_with_another_count_than_asked_for_is_refused_without_panic() {
        let short = hex::spaced(&modbus::with_crc(&[1, 3, 2, 0, 1]));
        let (_, reply) = ask(&Query::ReadHoldingRegisters { first: 0, count: 2 }, &short);
        assert!(matches!(reply, Err(Failure::Garbled { .. })), "{reply:?}");
    }

    #[test]
    fn a_failed_exchange_is_told_as_it_is() {
        let query = Query::ReadCoils { first: 0, count: 1 };
        assert_eq!(transact(&runtime(), 1, &query, |_| Err(Failure::Silent)), Err(Failure::Silent));
    }
}

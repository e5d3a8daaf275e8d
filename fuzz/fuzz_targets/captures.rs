//! Captures: frames that are read, or a reason why they are not.
#![no_main]

use dcon_bench::capture;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut bytes = 0;
    for outcome in capture::read_bytes(data) {
        match outcome {
            Ok(frame) => bytes += frame.bytes.len(),
            Err(problem) => assert!(!problem.to_string().is_empty()),
        }
    }
    assert!(bytes <= data.len(), "{bytes} bytes out of a capture of {}", data.len());
});

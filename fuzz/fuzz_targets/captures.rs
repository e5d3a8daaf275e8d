//! Captures: frames that are read, or a reason why they are not; what is read can be written and read again.
#![no_main]

use dcon_bench::capture::{self, CaptureWriter, Form};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let (frames, problem) = capture::read_bytes(data);
    if let Some(problem) = problem {
        assert!(!problem.to_string().is_empty());
    }
    let bytes: usize = frames.iter().map(|frame| frame.bytes.len()).sum();
    assert!(bytes <= data.len(), "{bytes} bytes out of a capture of {}", data.len());

    let mut writer = CaptureWriter::new(Form::Text, Vec::new(), "fuzzed").expect("memory takes all");
    for frame in &frames {
        writer.frame(frame).expect("memory takes all");
    }
    let text = writer.finish().expect("memory takes all");
    let (again, problem) = capture::read_bytes(&text);
    assert!(problem.is_none(), "{problem:?}");
    assert_eq!(again.len(), frames.len());
});

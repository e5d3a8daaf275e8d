//! The console that the program was started from. Windows gives a program with a window none, so the command line borrows
//! its parent's. Unsafe is only what the standard library has no function for.

use std::ffi::c_void;
use std::fs::File;
use std::os::windows::io::IntoRawHandle;

type Handle = *mut c_void;

/// Input, output and errors, by the numbers that Windows has for them, and the device that stands for each in a console.
const STANDARD: [(u32, &str); 3] = [(0xFFFF_FFF6, "CONIN$"), (0xFFFF_FFF5, "CONOUT$"), (0xFFFF_FFF4, "CONOUT$")];
const PARENT: u32 = u32::MAX;
const TYPE_UNKNOWN: u32 = 0;
/// A console, or nothing.
const TYPE_CHARACTERS: u32 = 2;

#[link(name = "kernel32")]
unsafe extern "system" {
    safe fn AttachConsole(process: u32) -> i32;
    safe fn FreeConsole() -> i32;
    safe fn GetStdHandle(which: u32) -> Handle;
    /// Takes any number for a handle, and says that the type of a wrong one is unknown.
    safe fn GetFileType(handle: Handle) -> u32;
    /// Whoever writes to a standard handle gets an error if it is a wrong one.
    safe fn SetStdHandle(which: u32, handle: Handle) -> i32;
}

/// Takes part in the console of whoever started the program, if that has one. What was redirected into a file, a pipe or
/// nothing stays so.
pub fn attach() {
    let given = STANDARD.map(|(which, _)| GetStdHandle(which));
    let redirected = given.map(|handle| GetFileType(handle) != TYPE_UNKNOWN);
    if AttachConsole(PARENT) == 0 {
        return;
    }
    for (((which, device), given), redirected) in STANDARD.into_iter().zip(given).zip(redirected) {
        let console = || File::options().read(true).write(true).open(device).ok().map(IntoRawHandle::into_raw_handle);
        if let Some(handle) = if redirected { Some(given) } else { console() } {
            SetStdHandle(which, handle);
        }
    }
}

/// Lets go of the console: closing it, or Ctrl-C in it, is not meant for the window. What is written from now on is dropped,
/// unless it was redirected into a file or a pipe.
pub fn leave() {
    for (which, _) in STANDARD {
        if GetFileType(GetStdHandle(which)) == TYPE_CHARACTERS {
            SetStdHandle(which, std::ptr::null_mut());
        }
    }
    FreeConsole();
}

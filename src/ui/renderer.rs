//! What the window is drawn with: OpenGL, which is there at once and quick without a graphics card, or where it cannot be
//! used wgpu (Vulkan, on Windows DirectX 12, which a remote desktop has while its OpenGL is too old).
//!
//! eframe keeps one event loop for all windows of the program, which runs again after a run that has ended. So where OpenGL
//! ends with an error, wgpu follows in the same process. A panic leaves the loop in the middle of its run: then the program
//! starts itself anew, with the other renderer asked for.

use std::any::Any;
use std::io;
use std::panic::{self, AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use eframe::egui::{Context, ViewportId};

#[cfg(windows)]
use crate::errors;
use crate::renderer::Renderer;
use crate::version::NAME;

/// Whether a window has been seen: what fails before was the renderer, or the start of the window with it.
#[derive(Clone, Debug, Default)]
pub struct FirstPicture(Arc<AtomicBool>);

impl FirstPicture {
    /// Notes, and tells the log, when the first picture of `ctx` is drawn. `start` is when the program began.
    pub fn watch(&self, ctx: &Context, start: Instant) {
        let drawn = self.0.clone();
        let note = move |ctx: &Context| {
            if ctx.cumulative_frame_nr_for(ViewportId::ROOT) > 0 && !drawn.swap(true, Ordering::Relaxed) {
                log::debug!("first picture after {} ms", start.elapsed().as_millis());
            }
        };
        ctx.on_begin_pass("first picture", Arc::new(move |ui| note(ui)));
    }

    fn is_drawn(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Why a window was not shown.
#[derive(Debug)]
enum Failure {
    /// Whatever the window is drawn with, it would come to the same.
    Window(String),
    /// It was there, and its display went away.
    Lost(String),
    Renderer(String),
    /// As above, and the event loop cannot be used again.
    Panic(String),
}

impl Failure {
    fn reason(&self) -> &str {
        match self {
            Self::Window(reason) | Self::Lost(reason) | Self::Renderer(reason) | Self::Panic(reason) => reason,
        }
    }
}

impl From<eframe::Error> for Failure {
    fn from(error: eframe::Error) -> Self {
        let reason = match &error {
            // Its own text lists everything that was wished for.
            eframe::Error::NoGlutinConfigs(_, reason) => format!("no configuration for a window: {reason}"),
            error => error.to_string().trim_end_matches([' ', '.']).to_owned(),
        };
        match error {
            eframe::Error::AppCreation(_) | eframe::Error::WinitEventLoop(_) => Self::Window(reason),
            _ => Self::Renderer(reason),
        }
    }
}

/// What to draw with: what the command line says, else what the environment does.
pub fn wanted(argument: Option<Renderer>) -> Renderer {
    let environment = || {
        let text = std::env::var_os(Renderer::VARIABLE).filter(|text| !text.is_empty())?;
        Renderer::from_environment(&text).inspect_err(|text| log::warn!("{text}")).ok()
    };
    argument.or_else(environment).unwrap_or_default()
}

/// Lets `show` show the window until it is closed. `show` notes the first picture.
pub fn run(wanted: Renderer, show: impl Fn(eframe::Renderer, FirstPicture) -> eframe::Result) -> ExitCode {
    let with_wgpu = || attempt(|first| show(eframe::Renderer::Wgpu, first));
    let with_opengl = || attempt(|first| show(eframe::Renderer::Glow, first));
    match wanted {
        Renderer::Opengl => ended(with_opengl()),
        Renderer::Wgpu => ended(with_wgpu()),
        Renderer::Auto => match with_opengl() {
            Err(opengl @ (Failure::Renderer(_) | Failure::Panic(_))) => {
                log::warn!("OpenGL cannot be used ({}), so wgpu is", opengl.reason());
                instead_of(opengl, with_wgpu)
            }
            outcome => ended(outcome),
        },
    }
}

fn instead_of(opengl: Failure, with_wgpu: impl FnOnce() -> Result<(), Failure>) -> ExitCode {
    match opengl {
        Failure::Panic(opengl) => start_anew("wgpu")
            .unwrap_or_else(|reason| could_not_be_shown(&format!("{opengl}; starting anew: {reason}"))),
        opengl => match with_wgpu() {
            Ok(()) => ExitCode::SUCCESS,
            Err(wgpu) => could_not_be_shown(&format!("OpenGL: {}; wgpu: {}", opengl.reason(), wgpu.reason())),
        },
    }
}

fn ended(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Lost(reason)) => {
            tell(&format!("The display went away ({reason}) – start again when it is back"));
            ExitCode::FAILURE
        }
        Err(failure) => could_not_be_shown(failure.reason()),
    }
}

fn could_not_be_shown(reason: &str) -> ExitCode {
    tell(&format!("The window could not be shown ({reason}) – use the command line instead, see {NAME} --help"));
    ExitCode::FAILURE
}

/// Says why there is no window.
fn tell(text: &str) {
    eprintln!("{text}");
    #[cfg(windows)]
    if !errors::are_read() {
        rfd::MessageDialog::new().set_level(rfd::MessageLevel::Error).set_title(NAME).set_description(text).show();
    }
}

/// Runs `show`. What panics before the first picture is a failure of it, and is not told as a panic; later ones go on.
fn attempt(show: impl FnOnce(FirstPicture) -> eframe::Result) -> Result<(), Failure> {
    let first = FirstPicture::default();
    let before: Arc<dyn Fn(&panic::PanicHookInfo<'_>) + Send + Sync> = panic::take_hook().into();
    let (others, drawn, drawing) = (before.clone(), first.clone(), std::thread::current().id());
    panic::set_hook(Box::new(move |info| {
        if drawn.is_drawn() || std::thread::current().id() != drawing {
            others(info);
        } else {
            log::debug!("{info}");
        }
    }));
    let outcome = catch_unwind(AssertUnwindSafe(|| show(first.clone())));
    panic::set_hook(Box::new(move |info| before(info)));
    match outcome {
        Ok(Err(eframe::Error::WinitEventLoop(error))) if first.is_drawn() => Err(Failure::Lost(error.to_string())),
        Ok(outcome) => outcome.map_err(Failure::from),
        Err(panic) if first.is_drawn() => resume_unwind(panic),
        Err(panic) => Err(Failure::Panic(said(&*panic))),
    }
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("for an unknown reason").to_owned()
}

/// Runs the program from its beginning with the same arguments, but for the renderer: in this process' place, or where a
/// system cannot do that (Windows) beside it, so that this one ends.
///
/// # Errors
///
/// What the system says.
fn start_anew(renderer: &str) -> io::Result<ExitCode> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(std::env::args_os().skip(1)).args(["--renderer", renderer]);
    #[cfg(unix)]
    return Err(std::os::unix::process::CommandExt::exec(&mut command));
    #[cfg(not(unix))]
    return command.spawn().map(|_| ExitCode::SUCCESS);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_before_the_first_picture_is_a_failure_that_says_why() {
        let outcome = attempt(|_| panic!("no matching configuration"));
        assert!(matches!(outcome, Err(Failure::Panic(reason)) if reason == "no matching configuration"));
    }

    #[test]
    #[should_panic(expected = "a mistake in the window")]
    fn a_panic_after_the_first_picture_goes_on() {
        let _ = attempt(|first| {
            first.0.store(true, Ordering::Relaxed);
            panic!("a mistake in the window")
        });
    }

    #[test]
    fn the_first_picture_is_noted_when_the_second_begins() {
        let (first, ctx) = (FirstPicture::default(), Context::default());
        first.watch(&ctx, Instant::now());
        let draw = || ctx.run_ui(eframe::egui::RawInput::default(), |_| ()).textures_delta.clear();
        draw();
        assert!(!first.is_drawn());
        draw();
        assert!(first.is_drawn());
    }

    #[test]
    fn a_window_that_fails_with_opengl_is_shown_with_wgpu() {
        let fails = |renderer, _| match renderer {
            eframe::Renderer::Glow => Err(eframe::Error::OpenGL(String::from("too old").into())),
            eframe::Renderer::Wgpu => Ok(()),
        };
        assert_eq!(run(Renderer::Auto, fails), ExitCode::SUCCESS);
        assert_eq!(run(Renderer::Opengl, fails), ExitCode::FAILURE);
        assert_eq!(run(Renderer::Wgpu, fails), ExitCode::SUCCESS);
    }
}

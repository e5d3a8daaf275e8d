//! What the window shall be drawn with.

use std::ffi::OsStr;

use clap::ValueEnum;

/// What the window is drawn with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Renderer {
    /// OpenGL, and wgpu where OpenGL cannot be used
    #[default]
    Auto,
    /// OpenGL 2.0 or OpenGL ES 2.0, and newer
    Opengl,
    /// Vulkan, on Windows DirectX 12
    Wgpu,
}

impl Renderer {
    /// The environment variable that is asked where the command line does not say it.
    pub const VARIABLE: &str = "DCON_BENCH_RENDERER";

    /// What the environment says, if `text` is what it says.
    ///
    /// # Errors
    ///
    /// What is wrong with it.
    pub fn from_environment(text: &OsStr) -> Result<Self, String> {
        let known = text.to_str().and_then(|text| Self::from_str(text, true).ok());
        known.ok_or_else(|| {
            format!("{} is {}, which is no renderer – use auto, opengl or wgpu", Self::VARIABLE, text.display())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_may_name_a_renderer_in_any_case() {
        assert_eq!(Renderer::from_environment(OsStr::new("wgpu")), Ok(Renderer::Wgpu));
        assert_eq!(Renderer::from_environment(OsStr::new("OpenGL")), Ok(Renderer::Opengl));
    }

    #[test]
    fn a_renderer_that_does_not_exist_is_refused_with_those_that_do() {
        let text = Renderer::from_environment(OsStr::new("metal")).unwrap_err();
        assert_eq!(text, "DCON_BENCH_RENDERER is metal, which is no renderer – use auto, opengl or wgpu");
    }
}

//! Tells the program which commit it was built from, on Windows gives it its icon, version and manifest, and lets the linker make
//! a release smaller where it can.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Whoever builds from an archive without history names the commit here.
const COMMIT: &str = "DCON_BENCH_COMMIT";

fn main() {
    println!("cargo::rerun-if-env-changed={COMMIT}");
    let commit = std::env::var(COMMIT).ok().filter(|commit| !commit.is_empty()).or_else(commit_of_checkout);
    let number = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let version = commit.map_or_else(|| number.clone(), |commit| format!("{number} ({commit})"));
    println!("cargo::rustc-env=DCON_BENCH_VERSION={version}");
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|is| is == value);
    if is("CARGO_CFG_TARGET_OS", "windows") {
        windows_resources(&number, &version);
    }
    let for_linux = is("CARGO_CFG_TARGET_OS", "linux") && is("CARGO_CFG_TARGET_ENV", "gnu");
    if for_linux && is("PROFILE", "release") && linker_takes(FOLD).unwrap_or(false) {
        println!("cargo::rustc-link-arg-bins={FOLD}");
    }
}

/// Of functions that are alike to the byte, one is kept; not of those that a passing panic stops in. LLD does this, which the
/// compiler brings along for PCs; other linkers refuse it.
const FOLD: &str = "-Wl,--icf=all";

/// Whether an empty program links with this argument.
fn linker_takes(argument: &str) -> Option<bool> {
    let variable = |name: &str| std::env::var(name).ok();
    let folder = PathBuf::from(variable("OUT_DIR")?);
    let source = folder.join("empty.rs");
    std::fs::write(&source, "fn main() {}").ok()?;
    let mut compiler = Command::new(variable("RUSTC")?);
    compiler.arg("--target").arg(variable("TARGET")?).args(variable("RUSTC_LINKER").map(|it| format!("-Clinker={it}")));
    compiler.args(variable("CARGO_ENCODED_RUSTFLAGS")?.split('\x1f').filter(|flag| !flag.is_empty()));
    compiler.arg(format!("-Clink-arg={argument}")).arg("-o").arg(folder.join("empty")).arg(source);
    Some(compiler.output().ok()?.status.success())
}

/// The short hash of what is checked out here; `None` outside of a checkout, or inside of another project's.
fn commit_of_checkout() -> Option<String> {
    let folder = std::env::var("CARGO_MANIFEST_DIR").ok()?;
    let top = git(&["rev-parse", "--show-cdup"])?;
    if !top.is_empty() {
        return None;
    }
    for file in ["HEAD", "logs/HEAD"] {
        let path = git(&["rev-parse", "--git-path", file])?;
        println!("cargo::rerun-if-changed={}", Path::new(&folder).join(path).display());
    }
    git(&["rev-parse", "--short=10", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Compiles the resources and links them. Where there is no resource compiler, the program goes without icon and version;
/// Microsoft's linker takes the manifest also by itself.
fn windows_resources(number: &str, version: &str) {
    for file in ["assets/windows/dcon-bench.rc", MANIFEST, "assets/icon/dcon-bench.ico"] {
        println!("cargo::rerun-if-changed={file}");
    }
    let gnu = std::env::var("CARGO_CFG_TARGET_ENV").is_ok_and(|env| env == "gnu");
    match compiled_resources(number, version, gnu) {
        Ok(object) => println!("cargo::rustc-link-arg-bins={}", object.display()),
        Err(reason) => {
            println!("cargo::warning=the program gets no icon and no version: {reason}");
            if !gnu {
                let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
                println!("cargo::rustc-link-arg-bins=/MANIFEST:EMBED");
                println!("cargo::rustc-link-arg-bins=/MANIFESTINPUT:{}", Path::new(&folder).join(MANIFEST).display());
            }
        }
    }
}

const MANIFEST: &str = "assets/windows/dcon-bench.manifest";

fn compiled_resources(number: &str, version: &str, gnu: bool) -> Result<PathBuf, String> {
    let numbers = format!("{},0", number.split(['-', '+']).next().unwrap_or_default().replace('.', ","));
    let folder = PathBuf::from(std::env::var("OUT_DIR").map_err(|error| error.to_string())?);
    let text = std::fs::read_to_string("assets/windows/dcon-bench.rc").map_err(|error| error.to_string())?;
    let script = folder.join("dcon-bench.rc");
    std::fs::write(&script, text.replace("@NUMBERS@", &numbers).replace("@VERSION@", version))
        .map_err(|error| format!("{}: {error}", script.display()))?;
    let compilers: &[&str] = if gnu { &["x86_64-w64-mingw32-windres", "windres"] } else { &["rc.exe", "llvm-rc"] };
    let object = folder.join(if gnu { "resources.o" } else { "resources.res" });
    for compiler in compilers {
        let mut command = Command::new(compiler);
        if gnu {
            command.args(["--input-format=rc", "--output-format=coff"]).arg(&script).arg(&object);
        } else {
            command.arg("/nologo").arg("/fo").arg(&object).arg(&script);
        }
        match command.status() {
            Ok(status) if status.success() => return Ok(object),
            Ok(status) => return Err(format!("{compiler} failed ({status})")),
            Err(_) => {}
        }
    }
    Err(format!("there is neither {}", compilers.join(" nor ")))
}

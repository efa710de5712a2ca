//! A compiler, a standard library and an emulator for 64-bit Arm, unpacked from Debian's packages into a folder of ours.
//!
//! Nothing is installed and no root is needed: apt only downloads, from wherever the system's own configuration says.
//! The compiler is Debian's, not the project's; it tests the code.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use xtask::setup::tool_folder;
use xtask::shell::{command, output, say};

/// The processor that is emulated: that of a Raspberry Pi 4.
const PROCESSOR: &str = "cortex-a72";
/// What a compiler, a linker and the emulator need of Debian 12 beyond what depends on the version of Rust.
const PACKAGES: [&str; 24] = [
    "binutils-aarch64-linux-gnu",
    "cpp-12-aarch64-linux-gnu",
    "gcc-12-aarch64-linux-gnu",
    "libbsd0",
    "libc6-arm64-cross",
    "libc6-dev-arm64-cross",
    "libcapstone4",
    "libedit2",
    "libffi8",
    "libgcc-12-dev-arm64-cross",
    "libgcc-s1-arm64-cross",
    "libglib2.0-0",
    "libicu72",
    "libisl23",
    "libmd0",
    "libmpc3",
    "libmpfr6",
    "libnuma1",
    "liburing2",
    "libxml2",
    "libz3-4",
    "linux-libc-dev-arm64-cross",
    "qemu-user",
    "rustc-web",
];

/// Where the unpacked programs are.
pub(super) struct Toolchain {
    folder: PathBuf,
}

impl Toolchain {
    /// The folder as it was left, or made now.
    pub(super) fn set_up() -> Result<Self> {
        let toolchain = Self { folder: tool_folder().join("arm64") };
        // Written last: a folder without it is not finished.
        let stamp = toolchain.folder.join("unpacked");
        let wanted = PACKAGES.join("\n");
        if fs::read_to_string(&stamp).is_ok_and(|unpacked| unpacked == wanted) {
            return Ok(toolchain);
        }
        if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
            bail!("the packages are for Linux on x86-64");
        }
        say("Unpacking a compiler and an emulator for 64-bit Arm (half a minute, once a machine)");
        if toolchain.folder.exists() {
            fs::remove_dir_all(&toolchain.folder).context("cannot clear the folder of the toolchain")?;
        }
        toolchain.unpack()?;
        for (name, program) in toolchain.programs() {
            toolchain.wrap(name, &program)?;
        }
        fs::write(&stamp, wanted).with_context(|| format!("cannot write {}", stamp.display()))?;
        Ok(toolchain)
    }

    /// `cargo` so that it builds for Arm, in a folder of its own since the compiler is another, and runs what it
    /// built under the emulator.
    pub(super) fn cargo(&self, arguments: &[&str]) -> Command {
        let mut cargo = xtask::shell::cargo(arguments);
        let program = |name: &str| self.folder.join("bin").join(name);
        cargo
            .env("RUSTC", program("rustc"))
            .env("RUSTDOC", program("rustdoc"))
            .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", program("aarch64-cc"))
            .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER", program("aarch64-run"))
            .env("CARGO_BUILD_TARGET", super::TARGET)
            .env("CARGO_TARGET_DIR", super::built());
        cargo
    }

    /// The emulator.
    pub(super) fn emulator(&self, arguments: &[&str]) -> Command {
        command(self.folder.join("bin/aarch64-run"), arguments)
    }

    fn unpack(&self) -> Result<()> {
        let apt = Apt::with_lists_in(&self.folder)?;
        let policy = apt.output("apt-cache", &["policy", "rustc-web"])?;
        let version = after(&policy, "Candidate: ").context("apt knows no package rustc-web")?;
        let short: Vec<&str> = version.splitn(3, '.').take(2).collect();
        let library = format!("libstd-rust-web-{}", short.join("."));
        let depends = apt.output("apt-cache", &["depends", &library, "rustc-web"])?;
        let llvm =
            depends.lines().find_map(|line| after(line, "Depends: ").filter(|d| d.starts_with("libllvm")));
        let mut packages: Vec<String> = PACKAGES.map(str::to_owned).into();
        packages.extend([library, llvm.context("Debian's compiler has no libllvm")?.to_owned()]);
        packages.extend(["", ":arm64"].map(|of| format!("libstd-rust-web-dev{of}={version}")));
        let packages: Vec<&str> = packages.iter().map(String::as_str).collect();
        let archives = self.folder.join("archives");
        apt.output("apt-get", &[&["-qq", "download"][..], &packages].concat())?;
        for archive in fs::read_dir(&archives)? {
            let mut unpack = command("dpkg-deb", &["-x"]);
            unpack.arg(archive?.path()).arg(self.root());
            output(unpack)?;
        }
        fs::remove_dir_all(archives).context("cannot remove the archives")
    }

    fn root(&self) -> PathBuf {
        self.folder.join("root")
    }

    /// What is called, by the name it is called by.
    fn programs(&self) -> [(&'static str, String); 4] {
        let root = self.root();
        let root = root.display();
        [
            ("rustc", format!("{root}/usr/bin/rustc")),
            ("rustdoc", format!("{root}/usr/bin/rustdoc")),
            ("aarch64-cc", format!("{root}/usr/bin/aarch64-linux-gnu-gcc-12 --sysroot={root}")),
            (
                "aarch64-run",
                format!(
                    "{root}/usr/bin/qemu-aarch64 -U LD_LIBRARY_PATH -cpu {PROCESSOR} \
                     -L {root}/usr/aarch64-linux-gnu"
                ),
            ),
        ]
    }

    /// A script that runs `program` with the libraries that were unpacked with it.
    fn wrap(&self, name: &str, program: &str) -> Result<()> {
        let libraries = self.root().join("usr/lib/x86_64-linux-gnu");
        let script = format!("#!/bin/sh\nLD_LIBRARY_PATH={} exec {program} \"$@\"\n", libraries.display());
        let path = self.folder.join("bin").join(name);
        fs::write(&path, script).with_context(|| format!("cannot write {}", path.display()))?;
        output(command("chmod", &["+x", &path.to_string_lossy()])).map(drop)
    }
}

/// apt with lists of its own, as if nothing were installed.
struct Apt {
    configuration: PathBuf,
    archives: PathBuf,
}

impl Apt {
    fn with_lists_in(folder: &Path) -> Result<Self> {
        let apt = folder.join("apt");
        for made in ["apt/lists/partial", "apt/cache/archives/partial", "archives", "root", "bin"] {
            fs::create_dir_all(folder.join(made)).with_context(|| format!("cannot make {made}"))?;
        }
        fs::write(apt.join("status"), "")?;
        let place = apt.display();
        let configuration = format!(
            "Dir::State \"{place}\"; Dir::State::lists \"{place}/lists\"; Dir::State::status \"{place}/status\";\n\
             Dir::Cache \"{place}/cache\"; APT::Architectures {{\"amd64\"; \"arm64\";}};\n\
             Acquire::Languages \"none\"; APT::Sandbox::User \"\";\n"
        );
        let path = apt.join("apt.conf");
        fs::write(&path, configuration)?;
        let apt = Self { configuration: path, archives: folder.join("archives") };
        apt.output("apt-get", &["-qq", "update"])?;
        Ok(apt)
    }

    fn output(&self, program: &str, arguments: &[&str]) -> Result<String> {
        let mut command = command(program, arguments);
        command.env("APT_CONFIG", &self.configuration).current_dir(&self.archives);
        output(command)
    }
}

/// What stands behind `word`, to the end of its line.
fn after<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    text.lines().find_map(|line| Some(line.split_once(word)?.1.trim()))
}

//! The program ffmpeg: found, started, and what it says while it runs.

use std::collections::VecDeque;
use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use super::VideoError;
use super::log::{Line, Shown};
use crate::files::one_line;
use crate::run::Program;

/// The environment variable that names the program.
pub const VARIABLE: &str = "AQUAFUSE_FFMPEG";

/// Formats of files that hold one video. Others, as lists of files, could read what nobody named.
const FORMATS: &str = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,flv,asf,ogg,mxf,nut,ivf,gif,apng,h264,hevc,\
m4v,dv,wtv,obu,av1,rm,yuv4mpegpipe,live_flv,gxf,vob,vc1,mjpeg,webp_pipe";

/// The option by which each frame is passed on, and the one before version 5.1.
const NEW: &str = "-fps_mode";
const OLD: &str = "-vsync";

/// The program ffmpeg.
#[derive(Clone, Debug)]
pub struct Ffmpeg {
    program: OsString,
    /// How frames are passed on one by one: the option has another name before version 5.1.
    passthrough: &'static str,
}

impl Ffmpeg {
    /// Its name.
    pub(super) const NAME: &'static str = "ffmpeg";

    /// The program that the environment variable `AQUAFUSE_FFMPEG` names, or else `ffmpeg` of the search path.
    ///
    /// # Errors
    ///
    /// [`VideoError::NoFfmpeg`] when it is not there, [`VideoError::Start`] when it does not run.
    pub fn find() -> Result<Self, VideoError> {
        let named = std::env::var_os(VARIABLE).filter(|name| !name.is_empty());
        let mut found = Self { program: named.unwrap_or_else(|| Self::NAME.into()), passthrough: NEW };
        let mut command = found.command();
        let said = command.arg("-version").stdin(Stdio::null()).stderr(Stdio::null()).output();
        let said = said.map_err(|error| found.not_started(&error))?;
        if is_before_5_1(&String::from_utf8_lossy(&said.stdout)) {
            found.passthrough = OLD;
        }
        Ok(found)
    }

    /// The program with the arguments of every call.
    pub(super) fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(["-hide_banner", "-nostdin", "-nostats", "-loglevel", "level+info"]);
        command
    }

    /// Whether it is of version 5.1 or later.
    pub(super) fn is_new(&self) -> bool {
        self.passthrough == NEW
    }

    /// Each frame as it comes, none dropped and none doubled.
    pub(super) fn passthrough(&self) -> [&'static str; 2] {
        [self.passthrough, "passthrough"]
    }

    /// Starts a command, and reads what it says on a thread of its own: a pipe that nobody reads would hold it up.
    pub(super) fn start(&self, command: &mut Command) -> Result<Running, VideoError> {
        command.stderr(Stdio::piped());
        let program = Program::start(command).map_err(|error| self.not_started(&error))?;
        let (sender, shown) = channel();
        let stderr = program.stderr();
        let listen =
            move || stderr.map(|stderr| Said::read(BufReader::new(stderr), &sender)).unwrap_or_default();
        let said = std::thread::Builder::new().spawn(listen).map_err(|error| self.not_started(&error))?;
        Ok(Running { program, shown, said: Some(said) })
    }

    fn not_started(&self, error: &std::io::Error) -> VideoError {
        let program = one_line(&self.program.to_string_lossy());
        match error.kind() {
            ErrorKind::NotFound => VideoError::NoFfmpeg { program },
            _ => VideoError::Start { program, cause: error.to_string() },
        }
    }
}

/// Whether a release is older than 5.1. Builds between releases have other names; they count as new.
fn is_before_5_1(version: &str) -> bool {
    let Some(name) = version.strip_prefix("ffmpeg version ").and_then(|rest| rest.split_whitespace().next())
    else {
        return false;
    };
    let mut numbers =
        name.trim_start_matches('n').split(['.', '-', '~']).map_while(|part| part.parse::<u32>().ok());
    match (numbers.next(), numbers.next()) {
        (Some(major), Some(minor)) => (major, minor) < (5, 1),
        (Some(major), None) => major <= 4,
        (None, _) => false,
    }
}

/// The arguments by which a file is read, whatever its name: as one file, which reads no others.
pub(super) fn input(path: &Path) -> [OsString; 6] {
    [
        "-protocol_whitelist".into(),
        "file,pipe".into(),
        "-format_whitelist".into(),
        FORMATS.into(),
        "-i".into(),
        file(path),
    ]
}

/// The name of a file in which nothing has a meaning of its own.
pub(super) fn file(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push::<&OsStr>(path.as_ref());
    name
}

/// A program that runs.
#[derive(Debug)]
pub(super) struct Running {
    pub(super) program: Program,
    /// What its filter `showinfo` says.
    pub(super) shown: Receiver<Shown>,
    said: Option<JoinHandle<Said>>,
}

impl Running {
    /// Waits for its end: how it ended, and what it said.
    pub(super) fn end(&mut self) -> (Option<ExitStatus>, Said) {
        let status = self.program.wait().ok();
        let said = self.said.take().and_then(|said| said.join().ok()).unwrap_or_default();
        (status, said)
    }
}

/// Complaints that are kept.
const FIRST: usize = 2;
const LAST: usize = 2;
/// Bytes of a line that are looked at.
const LINE: u64 = 16 << 10;

/// What the program complained about.
#[derive(Clone, Debug, Default)]
pub(super) struct Said {
    first: Vec<String>,
    last: VecDeque<String>,
    /// How many complaints there were.
    pub(super) count: u64,
    /// Frames that it wrote, by its last report.
    pub(super) frames: Option<u64>,
}

impl Said {
    fn read(mut from: impl BufRead, shown: &Sender<Shown>) -> Self {
        let mut said = Self::default();
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let length = std::io::Read::take(&mut from, LINE).read_until(b'\n', &mut bytes);
            if !length.is_ok_and(|length| length > 0) {
                return said;
            }
            match Line::parse(&String::from_utf8_lossy(&bytes)) {
                Some(Line::Shown(what)) => {
                    let _ = shown.send(what);
                }
                Some(Line::Complaint(what)) => said.add(what),
                Some(Line::Frames(frames)) => said.frames = Some(frames),
                None => {}
            }
        }
    }

    fn add(&mut self, mut complaint: String) {
        if complaint.starts_with("Format not on whitelist") {
            complaint.replace_range(
                ..,
                "it is of no format that holds one video; lists of files, images and subtitles are not read",
            );
        }
        self.count = self.count.saturating_add(1);
        if self.first.len() < FIRST {
            self.first.push(complaint);
            return;
        }
        if self.last.len() >= LAST {
            self.last.pop_front();
        }
        self.last.push_back(complaint);
    }

    /// The first and the last complaints, on one line.
    pub(super) fn words(&self) -> String {
        let mut lines: Vec<&str> = Vec::new();
        for line in self.first.iter().chain(&self.last) {
            // That of its first cause comes before it.
            let follows = line.starts_with("Error opening") && !lines.is_empty();
            if !follows && !lines.contains(&line.as_str()) {
                lines.push(line);
            }
        }
        match lines.is_empty() {
            true => "it says nothing".to_owned(),
            false => one_line(&lines.join("; ")),
        }
    }

    pub(super) fn has(&self, words: &str) -> bool {
        self.first.iter().chain(&self.last).any(|line| line.contains(words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_before_5_1_are_known() {
        for (name, is_old) in [
            ("ffmpeg version 5.1.9-0+deb12u1 Copyright", false),
            ("ffmpeg version 4.4.2-0ubuntu0.22.04.1 Copyright", true),
            ("ffmpeg version n5.0 Copyright", true),
            ("ffmpeg version 7.0.2-static", false),
            ("ffmpeg version 8-full_build", false),
            ("ffmpeg version N-109542-gaf1a1f7", false),
            ("", false),
        ] {
            assert_eq!(is_before_5_1(name), is_old, "{name}");
        }
    }

    #[test]
    fn the_first_and_the_last_complaints_are_kept() {
        let text = (0..100).map(|i| format!("[a @ 0x1] [error] number {i}\n")).collect::<String>();
        let said = Said::read(text.as_bytes(), &channel().0);
        assert_eq!((said.count, said.words().as_str()), (100, "number 0; number 1; number 98; number 99"));
    }
}

//! Runs the binary in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Diffuse walls, a glass and a mirror ball, an area light, and a caustic photon map.
pub(crate) const BALLS: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(Camera: (fov: 45), Transform: (translate: (0, 1, 4))),
    "/Render": Def(
        Render: (camera: "/Camera", samples: 4),
        Film: (resolution: (32, 32)),
        LightTransport: (indirect: PathTrace, caustic: PhotonMap),
        CausticPhotonMap: (photons: 2000),
    ),
    "/Floor": Def(Quad: (size: (4, 4)), Transform: (rotate: (-90, 0, 0)), Diffuse: (albedo: (0.7, 0.6, 0.5))),
    "/Back": Def(Quad: (size: (4, 4)), Transform: (translate: (0, 1, -2)), Diffuse: (albedo: (0.2, 0.5, 0.7))),
    "/Glass": Def(Sphere: (radius: 0.5), Transform: (translate: (-0.6, 0.6, 0)), Dielectric: (ior: 1.5)),
    "/Mirror": Def(Sphere: (radius: 0.5), Transform: (translate: (0.7, 0.5, -0.4)), Conductor: (reflectance: (0.9, 0.9, 0.9))),
    "/Lamp": Def(Quad: (size: (1, 1)), Transform: (translate: (0, 2.5, 0), rotate: (90, 0, 0)), Emission: (radiance: (8, 8, 8))),
})
"#;

/// A folder that is removed at the end, with a scene in it.
pub(crate) struct Folder(TempDir);

/// How a run ended.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Folder {
    /// An empty folder.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with this scene as `scene.ron`.
    pub(crate) fn with_scene(text: &str) -> Self {
        let folder = Self::new();
        folder.write("scene.ron", text);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names of all files, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The command, ready to run here; the words are separated by blanks.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(binary());
        command
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .stdin(Stdio::null());
        command
    }

    /// Runs `pipeline` with these words.
    pub(crate) fn run(&self, line: &str) -> Ran {
        finish(&mut self.command(line))
    }

    /// Runs `pipeline`, which has to succeed.
    pub(crate) fn succeed(&self, line: &str) -> Ran {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(0), "{line}\n{}", ran.stderr);
        ran
    }
}

/// Path of the binary under test.
pub(crate) fn binary() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_pipeline"))
}

/// Runs a command to its end.
pub(crate) fn finish(command: &mut Command) -> Ran {
    Ran::of(&command.output().unwrap())
}

impl Ran {
    fn of(output: &Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let ran = Self {
            code: output.status.code(),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        };
        assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
        ran
    }
}

/// Makes sure that a file is a whole PNG: it begins as one and its last chunk is there.
pub(crate) fn assert_whole_png(bytes: &[u8]) {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    assert!(bytes.ends_with(b"\0\0\0\0IEND\xaeB`\x82"));
}

//! A network of depth from a file.

use std::path::PathBuf;

use aquafuse_data::depth_network::{self, NetworkKind, NetworkOptions};
use pyo3::prelude::*;

use crate::error::Fault;
use crate::threads;

/// A network of depth, read once; images share it.
#[pyclass(frozen, module = "aquafuse._native")]
pub(crate) struct DepthNetwork(pub(crate) depth_network::DepthNetwork);

/// Reads a network. Its reader has threads that a process that was forked has not.
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    kind: Option<&str>,
    size: Option<u32>,
    seconds: Option<u32>,
) -> Result<depth_network::DepthNetwork, Fault> {
    if threads::is_forked() {
        return Err(Fault::argument(format!(
            "{} cannot be read in a process that was forked; read it before, as aquafuse.DepthNetwork, or start processes by \
             the method spawn",
            path.display()
        )));
    }
    let kind = kind.map(str::parse::<NetworkKind>).transpose().map_err(Fault::argument)?;
    let options = NetworkOptions { kind, side: size, seconds };
    threads::work(py, || Ok(depth_network::DepthNetwork::read(&path, &options)?))
}

#[pymethods]
impl DepthNetwork {
    #[new]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        kind: Option<&str>,
        size: Option<u32>,
        seconds: Option<u32>,
    ) -> Result<Self, Fault> {
        read(py, path, kind, size, seconds).map(Self)
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.0.origin().0.to_owned()
    }

    #[getter]
    fn sha256(&self) -> String {
        self.0.origin().1.to_owned()
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind().name()
    }

    #[getter]
    fn size(&self) -> Option<u32> {
        self.0.origin().2.side
    }

    #[getter]
    fn seconds(&self) -> Option<u32> {
        self.0.origin().2.seconds
    }
}

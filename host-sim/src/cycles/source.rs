//! Source file of an instruction. Each equation of the model has its own file, so inlined code is
//! attributed to equations.

use super::image::{Image, ImageError};
use addr2line::Loader;

/// Folder of the model's source.
const MODEL: &str = "vm-nostd/src/";
/// Folder of its kernels. An inlined kernel counts for the file it is inlined into.
const KERNELS: &str = "scalar";

/// Source files of an image.
pub struct Source(Loader);

impl Source {
    /// Reads the debug information of an image.
    pub fn of(image: &Image) -> Result<Self, ImageError> {
        let unread = |reason: Box<dyn std::error::Error>| ImageError::Lines {
            path: image.path.clone(),
            reason: reason.to_string(),
        };
        Loader::new(&image.path).map(Self).map_err(unread)
    }

    /// File of the code at an address: that of the innermost inlined call in the model outside the
    /// kernels, otherwise "out-of-line kernels" or "outside the model".
    pub fn file(&self, address: u32) -> String {
        let mut files = Vec::new();
        if let Ok(mut frames) = self.0.find_frames(address.into()) {
            while let Ok(Some(frame)) = frames.next() {
                files.extend(frame.location.and_then(|place| place.file).map(str::to_owned));
            }
        }
        equation(files.iter().map(String::as_str)).to_owned()
    }
}

/// Selects the file; `files` run from the innermost to the outermost call.
fn equation<'a>(files: impl Iterator<Item = &'a str>) -> &'a str {
    let mut found = "outside the model";
    for (_, file) in files.filter_map(|file| file.rsplit_once(MODEL)) {
        if !file.starts_with(KERNELS) {
            return file;
        }
        found = "out-of-line kernels";
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inlined_kernels_count_for_the_enclosing_equation() {
        let equation = |files: &[&'static str]| equation(files.iter().copied());
        let inlined =
            ["/a/vm-nostd/src/scalar/float/single.rs", "/a/vm-nostd/src/equations/sag.rs"];
        assert_eq!(equation(&inlined), "equations/sag.rs");
        let core = ["/rustc/1/library/core/src/ops/arith.rs", "/a/vm-nostd/src/recruitment/fes.rs"];
        assert_eq!(equation(&core), "recruitment/fes.rs");
        assert_eq!(equation(&inlined[..1]), "out-of-line kernels");
        assert_eq!(equation(&["other.c"]), "outside the model");
        assert_eq!(equation(&[]), "outside the model");
    }
}

//! Source file of an instruction. In the model each equation has its own file, so that this
//! attributes inlined code to equations.

use super::image::{Image, ImageError};
use addr2line::Loader;

/// Folder of the model's source.
const MODEL: &str = "vm-nostd/src/";
/// Folder of its kernels, which count for the file they are inlined into.
const KERNELS: &str = "scalar";

/// Source files of an image.
pub struct Source(Loader);

impl Source {
    /// Debug information of an image.
    pub fn of(image: &Image) -> Result<Self, ImageError> {
        let unread = |reason: Box<dyn std::error::Error>| ImageError::Lines {
            path: image.path.clone(),
            reason: reason.to_string(),
        };
        Loader::new(&image.path).map(Self).map_err(unread)
    }

    /// File of the code at an address: the innermost inlined call in the model that is no kernel;
    /// without one, "kernels" or "not of the model".
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

/// The file that counts, from the innermost to the outermost call.
fn equation<'a>(files: impl Iterator<Item = &'a str>) -> &'a str {
    let mut found = "not of the model";
    for (_, file) in files.filter_map(|file| file.rsplit_once(MODEL)) {
        if !file.starts_with(KERNELS) {
            return file;
        }
        found = "kernels that are called";
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_counts_for_the_equation_that_it_was_inlined_into() {
        let equation = |files: &[&'static str]| equation(files.iter().copied());
        let inlined =
            ["/a/vm-nostd/src/scalar/float/single.rs", "/a/vm-nostd/src/equations/sag.rs"];
        assert_eq!(equation(&inlined), "equations/sag.rs");
        let core = ["/rustc/1/library/core/src/ops/arith.rs", "/a/vm-nostd/src/recruitment/fes.rs"];
        assert_eq!(equation(&core), "recruitment/fes.rs");
        assert_eq!(equation(&inlined[..1]), "kernels that are called");
        assert_eq!(equation(&["other.c"]), "not of the model");
        assert_eq!(equation(&[]), "not of the model");
    }
}

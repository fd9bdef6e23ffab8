//! Progress bars: label, bar and time left, on standard error if that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Label, bar, count and time left.
const TEMPLATE: &str = "{msg} [{bar:30}] {pos}/{len}, {eta} left";

/// A bar of `count` steps with a label.
pub(crate) fn bar(label: &'static str, count: usize) -> ProgressBar {
    let style = ProgressStyle::with_template(TEMPLATE).expect("a built-in template");
    ProgressBar::new(count as u64).with_style(style.progress_chars("=> ")).with_message(label)
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::{ProgressDrawTarget, TermLike};
    use std::io::Result;
    use std::sync::{Arc, Mutex};

    /// A terminal that keeps what is written to it.
    #[derive(Debug, Clone, Default)]
    struct Kept(Arc<Mutex<String>>);

    impl Kept {
        fn add(&self, text: &str) -> Result<()> {
            self.0.lock().expect("one thread").push_str(text);
            Ok(())
        }
    }

    impl TermLike for Kept {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> Result<()> {
            self.add(text)
        }
        fn write_str(&self, text: &str) -> Result<()> {
            self.add(text)
        }
        fn clear_line(&self) -> Result<()> {
            Ok(())
        }
        fn flush(&self) -> Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_bar_shows_its_label_the_count_and_the_time_left() {
        let terminal = Kept::default();
        let bar = bar("comparing scenarios", 120);
        bar.set_draw_target(ProgressDrawTarget::term_like(Box::new(terminal.clone())));
        bar.inc(30);
        bar.force_draw();
        let text = terminal.0.lock().expect("one thread").clone();
        for words in ["comparing scenarios", "30/120", " left"] {
            assert!(text.contains(words), "no \"{words}\" in: {text}");
        }
    }
}

//! Tables of numbers as aligned Markdown.

use comfy_table::{CellAlignment, Table, presets};

/// An empty table; the columns `right` are aligned to the right.
pub(crate) fn markdown_table(header: &[&str], right: impl IntoIterator<Item = usize>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(header.iter().copied());
    for column in right {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

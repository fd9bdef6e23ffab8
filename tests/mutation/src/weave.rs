//! Puts all mutants of a source into one text, which chooses among them at run time.
//!
//! `a + b` becomes `match (a, b) { (l, r) => if on(7) { l - r } else { l + r } }`: operands stand
//! there once, however deep they are nested. A function that the compiler may evaluate loses its
//! `const`, unless the compiler does evaluate it.

use crate::mutant::{Genre, Mutant};
use crate::syntax::{Context, Site, sites};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::ops::Range;

/// A source with its mutants.
#[derive(Debug, Default)]
pub struct Woven {
    /// The text.
    pub text: String,
    /// Where the changes are in it. The innermost comes last.
    pub places: Vec<Placed>,
    /// Mutants that are not in it, and why.
    pub apart: BTreeMap<usize, String>,
    /// Mutants that are no Rust, and why.
    pub unviable: BTreeMap<usize, String>,
}

/// What the compiler may complain of.
#[derive(Debug, PartialEq)]
pub struct Placed {
    /// Bytes of the text.
    pub bytes: Range<usize>,
    /// The mutants that are there.
    pub mutants: Vec<usize>,
    /// It is what one mutant puts in place, and nothing else.
    pub is_replacement: bool,
}

enum Piece {
    New(String),
    Source(Range<usize>),
    Mutant(usize, String),
}

struct Node {
    range: Range<usize>,
    pieces: Vec<Piece>,
    mutants: Vec<usize>,
}

/// The guard of an arm: its place, its pieces, and the mutants in it.
type Guard = (Range<usize>, Vec<Piece>, Vec<usize>);

/// Puts the mutants into a source, each with its number; but none that is `left_out`. Functions
/// with a name in `evaluated` stay `const`.
pub fn weave(
    source: &str,
    mutants: &[(usize, &Mutant)],
    left_out: &HashSet<usize>,
    evaluated: &BTreeSet<String>,
) -> Result<Woven, String> {
    let sites = sites(source)?;
    let mut woven = Woven::default();
    // The mutants of a place, in the order of the places.
    let mut at: BTreeMap<(usize, Genre), Vec<(usize, &Mutant)>> = BTreeMap::new();
    for &(number, mutant) in mutants {
        let start = mutant.bytes(source).start;
        let apart = match sites.found.get(&(mutant.genre, start)) {
            None => "not found in the syntax".into(),
            Some((Site::Chained, _)) if mutant.replacement == "||" => {
                woven.unviable.insert(number, "only && chains with let".into());
                continue;
            }
            Some((Site::Chained, _)) => "chained with let".into(),
            Some((_, Context::Constant)) => "a constant".into(),
            Some((_, Context::ConstFunction(function))) if evaluated.contains(&function.name) => {
                format!("evaluated by the compiler: {}", function.name)
            }
            Some(_) if left_out.contains(&number) => continue,
            Some(_) => {
                at.entry((start, mutant.genre)).or_default().push((number, mutant));
                continue;
            }
        };
        woven.apart.insert(number, apart);
    }
    let mut nodes: Vec<Node> = Vec::new();
    for function in &sites.const_functions {
        if !evaluated.contains(&function.name) {
            let range = function.word.clone();
            nodes.push(Node { range, pieces: Vec::new(), mutants: Vec::new() });
        }
    }
    // An arm and its guard are one place.
    let mut guards: BTreeMap<usize, Guard> = BTreeMap::new();
    for (&(start, genre), here) in &at {
        let (site, _) = &sites.found[&(genre, start)];
        let mutants: Vec<usize> = here.iter().map(|(number, _)| *number).collect();
        match site {
            Site::Arm { pattern_end, guard } => {
                let off = |number: &usize| format!("!crate::woven::on({number})");
                let off = mutants.iter().map(off).collect::<Vec<_>>().join(" && ");
                match guard {
                    None => nodes.push(Node {
                        range: *pattern_end..*pattern_end,
                        pieces: vec![Piece::New(format!(" if {off}"))],
                        mutants,
                    }),
                    Some(guard) => {
                        let entry = guards.entry(guard.start);
                        let (_, pieces, all) =
                            entry.or_insert_with(|| (guard.clone(), Vec::new(), Vec::new()));
                        pieces.insert(0, Piece::New(format!("{off} && ")));
                        all.extend(mutants);
                    }
                }
            }
            Site::Guard(guard) => {
                let entry = guards.entry(guard.start);
                let (_, pieces, all) =
                    entry.or_insert_with(|| (guard.clone(), Vec::new(), Vec::new()));
                for (number, mutant) in here {
                    pieces.push(Piece::New(format!("if crate::woven::on({number}) {{ ")));
                    pieces.push(Piece::Mutant(*number, mutant.replacement.clone()));
                    pieces.push(Piece::New(" } else ".into()));
                }
                all.extend(mutants);
            }
            site => nodes.push(node(source, site, here, mutants)?),
        }
    }
    for (_, (range, mut pieces, mutants)) in guards {
        pieces.push(Piece::New("{ ".into()));
        pieces.push(Piece::Source(range.clone()));
        pieces.push(Piece::New(" }".into()));
        nodes.insert(0, Node { range, pieces, mutants });
    }
    // What encloses another comes first; a guard before the expression that it is.
    nodes.sort_by_key(|node| {
        (node.range.start, !node.range.is_empty(), usize::MAX - node.range.len())
    });
    render(source, &nodes, 0, 0..source.len(), &mut woven);
    Ok(woven)
}

fn node(
    source: &str,
    site: &Site,
    here: &[(usize, &Mutant)],
    mutants: Vec<usize>,
) -> Result<Node, String> {
    let new = |text: &str| Piece::New(text.into());
    // One alternative for each mutant, then what stood there.
    let choose = |mutated: &dyn Fn(&str) -> String, original: String| {
        let mut pieces = Vec::new();
        for (number, mutant) in here {
            pieces.push(Piece::New(format!("if crate::woven::on({number}) {{ ")));
            pieces.push(Piece::Mutant(*number, mutated(&mutant.replacement)));
            pieces.push(new(" } else "));
        }
        pieces.push(Piece::New(format!("{{ {original} }}")));
        pieces
    };
    Ok(match site {
        Site::Body(open) => {
            let mut pieces = Vec::new();
            for (number, mutant) in here {
                pieces.push(Piece::New(format!(" if crate::woven::on({number}) {{ return ")));
                pieces.push(Piece::Mutant(*number, mutant.replacement.clone()));
                pieces.push(new("; }"));
            }
            Node { range: *open..*open, pieces, mutants }
        }
        Site::Unary { whole, operand } => {
            let operator = &source[whole.start..operand.start];
            let mut pieces = vec![new("(match ("), Piece::Source(operand.clone())];
            pieces.push(new(") { v => "));
            pieces.extend(choose(&|_| "v".into(), format!("{operator} v")));
            pieces.push(new(" })"));
            Node { range: whole.clone(), pieces, mutants }
        }
        Site::Binary { whole, left, right } => {
            let (left, right) = (Piece::Source(left.clone()), Piece::Source(right.clone()));
            let (_, first) = here.first().ok_or("a place without a mutant")?;
            let operator = source[first.bytes(source)].to_owned();
            let mut pieces = Vec::new();
            match &*operator {
                "&&" | "||" => {
                    // The right side is evaluated if the left one is true, or false if it is on.
                    let [(number, _)] = here else { return Err("two ways to chain".into()) };
                    let same = if operator == "&&" { "!=" } else { "==" };
                    pieces.extend([new("(match ("), left, new(") { l => if l ")]);
                    pieces.push(Piece::New(format!("{same} crate::woven::on({number}) {{ ")));
                    pieces.extend([right, new(" } else { l } })")]);
                }
                "==" | "!=" | "<" | ">" | "<=" | ">=" => {
                    pieces.extend([new("(match (&("), left, new("), &("), right]);
                    pieces.push(new(")) { (l, r) => "));
                    pieces.extend(choose(&|op| format!("*l {op} *r"), format!("*l {operator} *r")));
                    pieces.push(new(" })"));
                }
                assigned if assigned.ends_with('=') => {
                    pieces.extend([new("(match ("), right, new(") { r => match &mut ("), left]);
                    pieces.push(new(") { l => "));
                    pieces.extend(choose(&|op| format!("*l {op} r"), format!("*l {assigned} r")));
                    pieces.push(new(" } })"));
                }
                _ => {
                    pieces.extend([new("(match ("), left, new(", "), right, new(") { (l, r) => ")]);
                    pieces.extend(choose(&|op| format!("l {op} r"), format!("l {operator} r")));
                    pieces.push(new(" })"));
                }
            }
            Node { range: whole.clone(), pieces, mutants }
        }
        Site::Field { value, base, name, shorthand } => {
            let mut pieces = Vec::new();
            if *shorthand {
                pieces.push(Piece::New(format!("{name}: ")));
            }
            for number in &mutants {
                pieces.push(Piece::New(format!("if crate::woven::on({number}) {{ ")));
                pieces.push(Piece::Mutant(*number, format!("({}).{name}", &source[base.clone()])));
                pieces.push(new(" } else "));
            }
            pieces.extend([new("{ "), Piece::Source(value.clone()), new(" }")]);
            Node { range: value.clone(), pieces, mutants }
        }
        Site::Arm { .. } | Site::Guard(_) | Site::Chained => return Err("not a node".into()),
    })
}

/// Writes a range of the source, with the nodes in it from the `next` one on.
fn render(source: &str, nodes: &[Node], next: usize, range: Range<usize>, woven: &mut Woven) {
    let mut cursor = range.start;
    for (index, node) in nodes.iter().enumerate().skip(next) {
        // Empty ones at the end belong to what is around.
        if node.range.start < cursor || node.range.end > range.end {
            continue;
        }
        if node.range.is_empty() && node.range.start == range.end {
            continue;
        }
        woven.text.push_str(&source[cursor..node.range.start]);
        let start = woven.text.len();
        let place = woven.places.len();
        let whole = Placed { bytes: 0..0, mutants: node.mutants.clone(), is_replacement: false };
        woven.places.push(whole);
        for piece in &node.pieces {
            match piece {
                Piece::New(text) => woven.text.push_str(text),
                Piece::Source(inner) => render(source, nodes, index + 1, inner.clone(), woven),
                Piece::Mutant(number, text) => {
                    let start = woven.text.len();
                    woven.text.push_str(text);
                    let bytes = start..woven.text.len();
                    let mutants = vec![*number];
                    woven.places.push(Placed { bytes, mutants, is_replacement: true });
                }
            }
        }
        woven.places[place].bytes = start..woven.text.len();
        cursor = node.range.end;
    }
    woven.text.push_str(&source[cursor..range.end]);
}

#[cfg(test)]
mod tests;

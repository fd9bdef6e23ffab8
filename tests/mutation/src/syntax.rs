//! What a mutant may change in a source, and whether that runs or is evaluated by the compiler.

use crate::mutant::{Genre, offset};
use proc_macro2::{LineColumn, Span};
use std::collections::HashMap;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// What a mutant changes, with everything that is needed to choose it at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Site {
    /// Behind the brace that opens a function's body.
    Body(usize),
    /// An operator between two expressions.
    Binary {
        /// Both and the operator.
        whole: Range<usize>,
        /// The left expression.
        left: Range<usize>,
        /// The right expression.
        right: Range<usize>,
    },
    /// An operator in front of an expression.
    Unary {
        /// Both.
        whole: Range<usize>,
        /// The expression.
        operand: Range<usize>,
    },
    /// An arm of a `match`.
    Arm {
        /// Behind its pattern.
        pattern_end: usize,
        /// Its guard.
        guard: Option<Range<usize>>,
    },
    /// The guard of an arm.
    Guard(Range<usize>),
    /// A field of a struct expression with a base.
    Field {
        /// What it is given.
        value: Range<usize>,
        /// The base.
        base: Range<usize>,
        /// Its name.
        name: String,
        /// It is named after what it is given, and stands there once.
        shorthand: bool,
    },
    /// Chained with `let`, for which no expression can be put in place.
    Chained,
}

/// Who evaluates a site.
#[derive(Clone, Debug, PartialEq)]
pub enum Context {
    /// The program.
    Run,
    /// The compiler or the program.
    ConstFunction(ConstFunction),
    /// The compiler.
    Constant,
}

/// A function that the compiler may evaluate.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstFunction {
    /// Its name.
    pub name: String,
    /// Its word `const`, with what follows it up to the next one.
    pub word: Range<usize>,
}

/// The sites of a source, by kind of change and by where that begins.
#[derive(Debug, Default)]
pub struct Sites {
    /// What is changed and who evaluates it.
    pub found: HashMap<(Genre, usize), (Site, Context)>,
    /// All functions that the compiler may evaluate.
    pub const_functions: Vec<ConstFunction>,
}

/// Finds all sites.
pub fn sites(source: &str) -> Result<Sites, String> {
    let file = syn::parse_file(source).map_err(|error| error.to_string())?;
    let mut finder = Finder { source, context: Context::Run, sites: Sites::default() };
    finder.visit_file(&file);
    Ok(finder.sites)
}

struct Finder<'s> {
    source: &'s str,
    context: Context,
    sites: Sites,
}

impl Finder<'_> {
    fn at(&self, place: LineColumn) -> usize {
        offset(self.source, place.line, place.column)
    }

    fn range(&self, of: impl Spanned) -> Range<usize> {
        let span: Span = of.span();
        self.at(span.start())..self.at(span.end())
    }

    fn add(&mut self, genre: Genre, start: usize, site: Site) {
        self.sites.found.insert((genre, start), (site, self.context.clone()));
    }

    fn within(&mut self, context: Context, visit: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.context, context);
        visit(self);
        self.context = outer;
    }

    fn function(
        &mut self,
        signature: &syn::Signature,
        body: &syn::Block,
        visit: impl FnOnce(&mut Self),
    ) {
        let context = match &signature.constness {
            Some(word) => {
                let start = self.range(word).start;
                let next =
                    signature.asyncness.as_ref().map_or(signature.fn_token.span(), |a| a.span());
                let next = signature.unsafety.as_ref().map_or(next, |u| u.span());
                let function = ConstFunction {
                    name: signature.ident.to_string(),
                    word: start..self.at(next.start()),
                };
                self.sites.const_functions.push(function.clone());
                Context::ConstFunction(function)
            }
            None => Context::Run,
        };
        self.within(context, |finder| {
            if let Some(first) = body.stmts.first() {
                let (start, open) = (finder.range(first).start, finder.range(body).start + 1);
                finder.add(Genre::FnValue, start, Site::Body(open));
            }
            visit(finder);
        });
    }

    fn expressions_chain(expression: &syn::ExprBinary) -> bool {
        let is_let = |side: &syn::Expr| match side {
            syn::Expr::Let(_) => true,
            syn::Expr::Binary(inner) => Self::expressions_chain(inner),
            _ => false,
        };
        matches!(expression.op, syn::BinOp::And(_))
            && (is_let(&expression.left) || is_let(&expression.right))
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block, |finder| visit::visit_item_fn(finder, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block, |finder| visit::visit_impl_item_fn(finder, item));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        match &item.default {
            Some(body) => self.function(&item.sig, body, |finder| {
                visit::visit_trait_item_fn(finder, item);
            }),
            None => visit::visit_trait_item_fn(self, item),
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.within(Context::Constant, |finder| visit::visit_item_const(finder, item));
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.within(Context::Constant, |finder| visit::visit_item_static(finder, item));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.within(Context::Constant, |finder| visit::visit_impl_item_const(finder, item));
    }

    fn visit_trait_item_const(&mut self, item: &'ast syn::TraitItemConst) {
        self.within(Context::Constant, |finder| visit::visit_trait_item_const(finder, item));
    }

    fn visit_expr_const(&mut self, block: &'ast syn::ExprConst) {
        self.within(Context::Constant, |finder| visit::visit_expr_const(finder, block));
    }

    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
        self.within(Context::Constant, |finder| finder.visit_expr(&repeat.len));
    }

    fn visit_type(&mut self, of: &'ast syn::Type) {
        self.within(Context::Constant, |finder| visit::visit_type(finder, of));
    }

    fn visit_variant(&mut self, variant: &'ast syn::Variant) {
        self.within(Context::Constant, |finder| visit::visit_variant(finder, variant));
    }

    fn visit_generic_argument(&mut self, argument: &'ast syn::GenericArgument) {
        self.within(Context::Constant, |finder| visit::visit_generic_argument(finder, argument));
    }

    fn visit_pat(&mut self, pattern: &'ast syn::Pat) {
        self.within(Context::Constant, |finder| visit::visit_pat(finder, pattern));
    }

    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        let operator = &binary.op;
        let start = self.range(operator).start;
        let site = if Self::expressions_chain(binary) {
            Site::Chained
        } else {
            Site::Binary {
                whole: self.range(binary),
                left: self.range(&binary.left),
                right: self.range(&binary.right),
            }
        };
        self.add(Genre::BinaryOperator, start, site);
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        let (whole, operand) = (self.range(unary), self.range(&unary.expr));
        self.add(Genre::UnaryOperator, whole.start, Site::Unary { whole, operand });
        visit::visit_expr_unary(self, unary);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        let guard = arm.guard.as_ref().map(|(_, guard)| self.range(guard));
        let chained = arm.guard.as_ref().is_some_and(|(_, guard)| match &**guard {
            syn::Expr::Let(_) => true,
            syn::Expr::Binary(binary) => Self::expressions_chain(binary),
            _ => false,
        });
        if let Some(guard) = &guard {
            let site = if chained { Site::Chained } else { Site::Guard(guard.clone()) };
            self.add(Genre::MatchArmGuard, guard.start, site);
        }
        let pattern_end = self.range(&arm.pat).end;
        let site = if chained { Site::Chained } else { Site::Arm { pattern_end, guard } };
        let start = self.range(arm).start;
        self.add(Genre::MatchArm, start, site);
        visit::visit_arm(self, arm);
    }

    fn visit_expr_struct(&mut self, expression: &'ast syn::ExprStruct) {
        if let Some(base) = &expression.rest {
            let base = self.range(base);
            for field in &expression.fields {
                let syn::Member::Named(name) = &field.member else { continue };
                let site = Site::Field {
                    value: self.range(&field.expr),
                    base: base.clone(),
                    name: name.to_string(),
                    shorthand: field.colon_token.is_none(),
                };
                let start = self.range(field).start;
                self.add(Genre::StructField, start, site);
            }
        }
        visit::visit_expr_struct(self, expression);
    }
}

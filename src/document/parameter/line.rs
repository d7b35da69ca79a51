//! Lines of the parameters' tables: what each has, and what it may add.

use std::ops::RangeInclusive;

use super::{Kind, Parameter, Precision, RowStyle, Stage, Takes};

impl<T> Parameter<T> {
    /// A parameter in no group, which always has an effect.
    pub(super) fn plain(
        key: &'static str,
        label: &'static str,
        help: &'static str,
        (kind, (get, set)): Takes<T>,
        stage: Stage,
    ) -> Self {
        Self {
            key,
            group: "",
            label,
            name: "",
            flag: None,
            symbol: "",
            help,
            kind,
            row: RowStyle {
                bar: None,
                step: 0.01,
                decimals: 3,
                is_percent: false,
            },
            stage,
            applies: |_| true,
            idle: |_| None,
            get,
            set,
        }
    }

    pub(super) fn named(mut self, name: &'static str) -> Self {
        self.name = name;
        self
    }

    pub(super) fn group(mut self, group: &'static str) -> Self {
        self.group = group;
        self
    }

    pub(super) fn flag(mut self, flag: &'static str) -> Self {
        self.flag = Some(flag);
        self
    }

    /// Without an option on the command line.
    pub(super) fn hidden(mut self) -> Self {
        self.flag = None;
        self
    }

    pub(super) fn applies(mut self, applies: fn(&T) -> bool) -> Self {
        self.applies = applies;
        self
    }

    pub(super) fn bar(mut self, low: f64, high: f64) -> Self {
        self.row.bar = Some([low, high]);
        self
    }

    pub(super) fn decimals(mut self, decimals: usize) -> Self {
        self.row.decimals = decimals;
        self
    }

    /// A share that panels show in per cent.
    pub(super) fn percent(mut self) -> Self {
        self.row = RowStyle {
            step: 0.01,
            is_percent: true,
            ..self.row
        };
        self
    }

    pub(super) fn symbol(mut self, symbol: &'static str) -> Self {
        self.symbol = symbol;
        self
    }

    pub(super) fn idle(mut self, idle: fn(&T) -> Option<&'static str>) -> Self {
        self.idle = idle;
        self
    }
}

pub fn ends(range: RangeInclusive<f64>) -> [f64; 2] {
    let (low, high) = range.into_inner();
    [low, high]
}

pub fn real(range: RangeInclusive<f64>, unit: &'static str) -> Kind {
    Kind::Number {
        range: ends(range),
        unit,
        precision: Precision::Double,
    }
}

/// A number in single precision, as its ends are.
pub fn single(range: RangeInclusive<f64>, unit: &'static str) -> Kind {
    Kind::Number {
        range: ends(range).map(|end| f64::from(end as f32)),
        unit,
        precision: Precision::Single,
    }
}

pub fn count(range: RangeInclusive<f64>) -> Kind {
    Kind::Number {
        range: ends(range),
        unit: "",
        precision: Precision::Whole,
    }
}

//! Reading a file of hitboxes; every complaint names the file, the entry, the bodies and the value.

use crate::read::Labels;
use crate::terminal::{self, quoted};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{Hitbox, Orientation, Sphere};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Formatter};
use std::ops::RangeInclusive;
use std::path::Path;

/// The schema, for the help of the option.
pub(crate) const HELP: &str = "\
JSON file with a hitbox, and an orientation if wanted, for some bodies; all others keep the radius.
A list of entries; a later one replaces an earlier one for the same body:
  [{\"body\": 3, \"half_space\": [0, 0, 1]},
   {\"bodies\": [10, 19],
    \"spheres\": [[x, y, z, radius], ...],
    \"orientation\": {\"knots\": [[t, x, y, z, w], ...], \"kind\": \"slerp\"}}]
body: a label, a number or a \"name\"; bodies: the first and the last of a range of numbers, which may have gaps.
half_space: the unit normal out of a half-space behind a plane through the body's position. It cannot turn.
spheres: centres in the body's axes and radii, m.
orientation: rotations as unit quaternions at times (s); kind: slerp (default) or normalized_cubic.";

/// The hitboxes of a file, by body.
pub(crate) struct Hitboxes {
    name: String,
    entries: Vec<Entry>,
}

/// The bodies that an entry is about.
#[derive(Clone, Debug)]
enum Bodies {
    Numbers(RangeInclusive<u64>),
    Name(String),
}

struct Entry {
    bodies: Bodies,
    hitbox: Hitbox,
    orientation: Orientation,
}

impl Hitboxes {
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let name = terminal::name(path);
        let bytes = std::fs::read(path).map_err(|error| format!("{name}: {error}"))?;
        let text = text_of(&bytes).map_err(|problem| format!("{name}: {problem}"))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = read_value(text).map_err(|problem| format!("{name}: {problem}"))?;
        serde_json::from_str::<UniqueNames>(text).map_err(|error| format!("{name}: {error}"))?;
        let Value::Array(list) = value else {
            return Err(format!(
                "{name}: {} is not a list of entries: give [{{\"body\": ..., ...}}, ...]",
                shown(&value)
            ));
        };
        let entries = list.iter().enumerate().map(|(number, value)| {
            let place = format!("{name}: entry {number}");
            Entry::of(value, text).map_err(|problem| format!("{place}{problem}"))
        });
        let entries = entries.collect::<Result<Vec<Entry>, String>>()?;
        Ok(Self { name, entries })
    }

    /// Returns the hitbox and the orientation by tag, of the bodies that have an entry, given the tags of all.
    /// Each entry must concern one.
    pub(crate) fn by_tag(
        &self,
        labels: &Labels,
        tags: &[u64],
    ) -> Result<BTreeMap<u64, (Hitbox, Orientation)>, String> {
        let name = |tag: u64| Some((labels.name(tag)?, tag));
        let names: BTreeMap<&str, u64> = tags.iter().filter_map(|&tag| name(tag)).collect();
        let number = |tag: u64| {
            let number = labels.name(tag).map_or(Some(tag), |name| name.parse().ok());
            Some((number?, tag))
        };
        let numbers: BTreeSet<(u64, u64)> = tags.iter().filter_map(|&tag| number(tag)).collect();
        let mut last: BTreeMap<u64, &Entry> = BTreeMap::new();
        for (number, entry) in self.entries.iter().enumerate() {
            let tags: Vec<u64> = match &entry.bodies {
                Bodies::Name(own) => names.get(&own[..]).copied().into_iter().collect(),
                Bodies::Numbers(range) => numbers
                    .range((*range.start(), 0)..=(*range.end(), u64::MAX))
                    .map(|&(_, tag)| tag)
                    .collect(),
            };
            if tags.is_empty() {
                let named = entry.bodies.named();
                let place = format!("{}: entry {number}, {named}", self.name);
                return Err(match &entry.bodies {
                    Bodies::Name(name) if names.is_empty() => match name.parse::<u64>() {
                        Ok(label) => format!(
                            "{place}: the labels of the states are numbers: write {label} without quotes"
                        ),
                        Err(_) => format!(
                            "{place}: the labels of the states are numbers: give one of them"
                        ),
                    },
                    _ => format!("{place}: no such body has states: name one that has"),
                });
            }
            last.extend(tags.into_iter().map(|tag| (tag, entry)));
        }
        let own = |entry: &Entry| (entry.hitbox.clone(), entry.orientation.clone());
        Ok(last
            .into_iter()
            .map(|(tag, entry)| (tag, own(entry)))
            .collect())
    }
}

impl Bodies {
    fn named(&self) -> String {
        match self {
            Self::Name(name) => format!("body {}", quoted(name.as_bytes())),
            Self::Numbers(range) if range.start() == range.end() => {
                format!("body {}", range.start())
            }
            Self::Numbers(range) => format!("bodies {} to {}", range.start(), range.end()),
        }
    }
}

impl Entry {
    /// The entry of a value in the text of the file. A problem begins with a comma or a colon.
    fn of(value: &Value, text: &str) -> Result<Self, String> {
        let Value::Object(members) = value else {
            let value = shown(value);
            return Err(format!(
                ": {value} is no entry: give {{\"body\": ..., ...}}"
            ));
        };
        let bodies = bodies(members, text).map_err(|problem| format!(": {problem}"))?;
        let entry = Self::of_bodies(bodies.clone(), members);
        entry.map_err(|problem| format!(", {}: {problem}", bodies.named()))
    }

    fn of_bodies(bodies: Bodies, members: &Map<String, Value>) -> Result<Self, String> {
        const MEMBERS: [&str; 5] = ["body", "bodies", "spheres", "half_space", "orientation"];
        check_members(members, &MEMBERS)?;
        let hitbox = match (members.get("spheres"), members.get("half_space")) {
            (Some(spheres), None) => cluster(spheres)?,
            (None, Some(normal)) => {
                let normal = numbers::<3>("half_space", normal, "[x, y, z]")?;
                let hitbox = Hitbox::half_space(DVec3::from_array(normal));
                hitbox.map_err(|error| format!("half_space: {error}"))?
            }
            _ => return Err("give either spheres or half_space".to_owned()),
        };
        let orientation = members.get("orientation");
        let orientation = orientation.map_or(Ok(Orientation::FIXED), orientation_of)?;
        if hitbox.normal().is_some() && !orientation.is_fixed() {
            return Err("orientation: a half-space cannot turn: leave it out".to_owned());
        }
        Ok(Self {
            bodies,
            hitbox,
            orientation,
        })
    }
}

fn bodies(members: &Map<String, Value>, text: &str) -> Result<Bodies, String> {
    let label = |value: &Value| {
        value.as_u64().ok_or_else(|| {
            let written = value.as_f64().and_then(|number| as_written(text, number));
            let value = written.map_or_else(|| shown(value), |written| cut(written.to_owned()));
            format!(
                "{value} is not a body's label, a whole number from 0 to {}",
                u64::MAX
            )
        })
    };
    match (members.get("body"), members.get("bodies")) {
        (Some(Value::String(name)), None) => Ok(Bodies::Name(name.clone())),
        (Some(body), None) => label(body).map(|body| Bodies::Numbers(body..=body)),
        (None, Some(Value::Array(ends))) if ends.len() == 2 => {
            let (first, last) = (label(&ends[0])?, label(&ends[1])?);
            if first > last {
                return Err(format!(
                    "bodies {first} to {last}: the first label is the larger one: swap them"
                ));
            }
            Ok(Bodies::Numbers(first..=last))
        }
        (None, Some(value)) => Err(format!(
            "bodies: {} is not a range: give [first, last]",
            shown(value)
        )),
        _ => Err("give either body or bodies".to_owned()),
    }
}

fn cluster(spheres: &Value) -> Result<Hitbox, String> {
    const EXPECTED: &str = "[x, y, z, radius]";
    let Value::Array(list) = spheres else {
        return Err(format!(
            "spheres: {} is not a list of {EXPECTED}",
            shown(spheres)
        ));
    };
    let spheres = list.iter().enumerate().map(|(number, value)| {
        let [x, y, z, radius] = numbers::<4>(&format!("sphere {number}"), value, EXPECTED)?;
        Ok(Sphere {
            offset: DVec3::new(x, y, z),
            radius,
        })
    });
    let spheres = spheres.collect::<Result<Vec<Sphere>, String>>()?;
    Hitbox::cluster(spheres).map_err(|error| format!("spheres: {error}"))
}

fn orientation_of(value: &Value) -> Result<Orientation, String> {
    let problem = |problem: String| format!("orientation: {problem}");
    let Value::Object(members) = value else {
        let value = shown(value);
        return Err(problem(format!("{value} is none: give {{\"knots\": ...}}")));
    };
    check_members(members, &["knots", "kind"]).map_err(problem)?;
    let Some(Value::Array(list)) = members.get("knots") else {
        let value = members
            .get("knots")
            .map_or_else(|| "nothing".to_owned(), shown);
        let expected = "a list of [t, x, y, z, w]";
        return Err(problem(format!("knots: {value} is not {expected}")));
    };
    let knots = list.iter().enumerate().map(|(number, value)| {
        let name = format!("orientation: knot {number}");
        let [time, x, y, z, w] = numbers::<5>(&name, value, "[t, x, y, z, w]")?;
        Ok((time, DQuat::from_xyzw(x, y, z, w)))
    });
    let knots = knots.collect::<Result<Vec<(f64, DQuat)>, String>>()?;
    let kind = members.get("kind").map_or(Some("slerp"), Value::as_str);
    let turn = match kind {
        Some("slerp") => Orientation::slerp(&knots),
        Some("normalized_cubic") => Orientation::normalized_cubic(&knots),
        _ => {
            let kind = shown(&members["kind"]);
            let expected = "expected \"slerp\" or \"normalized_cubic\"";
            return Err(problem(format!("kind: {kind} is unknown: {expected}")));
        }
    };
    turn.map_err(|error| problem(error.to_string()))
}

/// Returns the text of a file in UTF-8.
fn text_of(bytes: &[u8]) -> Result<&str, String> {
    std::str::from_utf8(bytes).map_err(|error| {
        let (before, after) = bytes.split_at(error.valid_up_to());
        let line = before.split(|&byte| byte == b'\n').count();
        let byte = after.first().copied().unwrap_or_default();
        format!("line {line}: byte {byte:#04x} is no text in UTF-8; save the file in UTF-8")
    })
}

/// Reads JSON. A problem in a list names the entry.
fn read_value(text: &str) -> Result<Value, String> {
    let read = match serde_json::from_str::<Listed>(text) {
        Ok(Listed(list)) => return Ok(Value::Array(list)),
        Err(_) if !text.trim_start().starts_with('[') => serde_json::from_str(text),
        Err(error) => Err(error),
    };
    read.map_err(|error| {
        let problem = error.to_string();
        // It is JSON all the same.
        let is_range = problem.contains("number out of range");
        format!("{}{problem}", if is_range { "" } else { "not JSON: " })
    })
}

/// A list of JSON values.
struct Listed(Vec<Value>);

impl<'de> Deserialize<'de> for Listed {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_seq(Self(Vec::new()))
    }
}

impl<'de> Visitor<'de> for Listed {
    type Value = Self;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "a list of entries")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut list: A) -> Result<Self, A::Error> {
        loop {
            let next = list.next_element::<Value>();
            let number = self.0.len();
            match next.map_err(|error| Error::custom(format!("entry {number}: {error}")))? {
                Some(value) => self.0.push(value),
                None => return Ok(self),
            }
        }
    }
}

/// JSON in which no object has two members of one name: of these `serde_json` keeps the last one.
struct UniqueNames;

impl<'de> Deserialize<'de> for UniqueNames {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_any(Self)
    }
}

impl<'de> Visitor<'de> for UniqueNames {
    type Value = Self;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "JSON")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Self, A::Error> {
        let mut names = BTreeSet::new();
        while let Some(name) = members.next_key::<String>()? {
            let shown = quoted(name.as_bytes());
            if !names.insert(name) {
                return Err(Error::custom(format!("{shown} is given twice")));
            }
            members.next_value::<Self>()?;
        }
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self, A::Error> {
        while list.next_element::<Self>()?.is_some() {}
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_unit<E>(self) -> Result<Self, E> {
        Ok(self)
    }
}

/// Refuses members of other names: a slip would go unnoticed.
fn check_members(members: &Map<String, Value>, known: &[&str]) -> Result<(), String> {
    let unknown = members.keys().find(|name| !known.contains(&name.as_str()));
    unknown.map_or(Ok(()), |name| {
        let name = quoted(name.as_bytes());
        Err(format!("{name} is unknown: expected {}", known.join(", ")))
    })
}

/// Reads a list of so many numbers.
fn numbers<const COUNT: usize>(
    name: &str,
    value: &Value,
    expected: &str,
) -> Result<[f64; COUNT], String> {
    let list = value.as_array().filter(|list| list.len() == COUNT);
    let Some(list) = list else {
        let value = shown(value);
        return Err(format!("{name}: {value} is not {expected}"));
    };
    let mut numbers = [0.0; COUNT];
    for (number, value) in numbers.iter_mut().zip(list) {
        *number = value.as_f64().ok_or_else(|| {
            let value = shown(value);
            format!("{name}: {value} is not a number: give {expected}")
        })?;
    }
    Ok(numbers)
}

/// Returns the first number of a text that has this value, as it is written there.
fn as_written(text: &str, number: f64) -> Option<&str> {
    let is_part = |character: char| matches!(character, '0'..='9' | '+' | '-' | '.' | 'e' | 'E');
    let mut words = text.split(|character| !is_part(character));
    words.find(|word| {
        word.parse::<f64>()
            .is_ok_and(|value| value.total_cmp(&number).is_eq())
    })
}

/// A value about as it stands in the file, cut if it is long.
fn shown(value: &Value) -> String {
    cut(value.to_string())
}

fn cut(text: String) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

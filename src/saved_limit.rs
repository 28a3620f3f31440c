//! Limits of counts, written so that machines with shorter and longer counts read them. No limit stays none.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "the signature that serde asks for"
)]
pub(crate) fn serialize<S: Serializer>(limit: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    let saved = match *limit {
        usize::MAX => u64::MAX,
        some => some as u64,
    };
    saved.serialize(serializer)
}

/// Reads a limit. One that no count of this machine exceeds is no limit.
pub(crate) fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<usize, D::Error> {
    let limit = u64::deserialize(deserializer)?;
    Ok(usize::try_from(limit).unwrap_or(usize::MAX))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use crate::query::Query;

    #[test]
    fn no_limit_is_read_on_every_machine() {
        let query = Query::default().with_max_spans(usize::MAX);
        let text = serde_json::to_string(&query).unwrap();
        assert_eq!(serde_json::from_str::<Query>(&text).unwrap(), query);
        let of_longer_counts = format!(r#"{{"max_spans":{}}}"#, u64::MAX);
        let read: Query = serde_json::from_str(&of_longer_counts).unwrap();
        assert_eq!(read, query);
    }
}

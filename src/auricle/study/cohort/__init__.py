"""Many cases: a study's file, its cases on one machine or many, their results, costs and crate."""

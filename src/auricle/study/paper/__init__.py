"""The paper reproduced: one case, the conventions it may have used, and the cohort's tables."""

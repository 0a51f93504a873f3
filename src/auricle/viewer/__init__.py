"""The live page: what it shows, the server behind it, and the page one can send."""

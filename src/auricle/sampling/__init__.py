"""What a spectrum says of sampling: how many points, how far apart, at what error."""

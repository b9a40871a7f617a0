"""Hard cases of the oracle, a module a theme: each says what is asked, and what is right by other means."""

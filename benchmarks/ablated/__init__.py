"""What each rule of the diagnosis is worth, on both challenges and on real recordings."""

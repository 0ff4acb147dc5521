#pragma once

namespace kolsky {

/// Has the process keep the memory that it frees for what it asks for next: a page that went back
/// to the system costs a fault when it is used again, and on virtual machines that takes up to
/// milliseconds, between a sample and its result too; an identification, whose matrices come and
/// go, takes half the time. For a program's main, before it does anything.
void keep_freed_memory() noexcept;

}  // namespace kolsky

#include "drivers/simulated/kernel_buffers.hpp"

#include <gtest/gtest.h>

#include "drivers/simulated/scan_layout.hpp"

namespace kolsky {
namespace {

TEST(KernelBuffers, LoseNothingWhileTheClientKeepsUp) {
  KernelBuffers buffers(1000, 4);
  for (Tick block = 0; block < 20; ++block) {
    EXPECT_EQ(buffers.block_start(), 1000 + 100 * block);
    EXPECT_EQ(buffers.lost_before(), 0);
    buffers.finish_block(1100 + 100 * block, 1100 + 100 * block + 5);
  }
}

TEST(KernelBuffers, HoldAsManyBlocksAsThereAreBuffers) {
  // The client sleeps until 400: four blocks of 100 are there. Their buffers come back at once, so
  // the fifth began at 400 and nothing is lost.
  KernelBuffers buffers(0, 4);
  EXPECT_FALSE(buffers.overrun(400, 100));
  EXPECT_TRUE(buffers.overrun(401, 100));
  for (Tick block = 0; block < 4; ++block) {
    buffers.finish_block(100 * (block + 1), 400);
    EXPECT_EQ(buffers.lost_before(), 0);
  }
  EXPECT_EQ(buffers.block_start(), 400);
}

TEST(KernelBuffers, LoseWhatCameWhileAllWereFull) {
  // The client sleeps until 1000. Blocks 0 to 3 hold ticks 0 to 399; the fifth begins when the
  // first buffer came back, at 1000, so 600 are gone.
  KernelBuffers buffers(0, 4);
  for (Tick block = 0; block < 3; ++block) {
    buffers.finish_block(100 * (block + 1), 1000);
    EXPECT_EQ(buffers.lost_before(), 0);
  }
  buffers.finish_block(400, 1000);
  EXPECT_EQ(buffers.lost_before(), 600);
  EXPECT_EQ(buffers.block_start(), 1000);
}

TEST(KernelBuffers, OneBufferLosesWhileTheClientHoldsIt) {
  KernelBuffers buffers(0, 1);
  buffers.finish_block(100, 130);
  EXPECT_EQ(buffers.block_start(), 130);
  EXPECT_EQ(buffers.lost_before(), 30);
}

TEST(ScanLayout, AlignsAsTheKernelDoes) {
  // Three channels of 2 bytes and a counter of 4: the counter stands at 8, the scan has 12 bytes.
  const std::vector<std::size_t> bytes{2, 2, 2, 4};
  const ScanLayout all({0xf}, bytes);
  EXPECT_EQ(all.bytes(), 12U);
  EXPECT_EQ(all.elements().back().offset, 8U);
  EXPECT_EQ(all.mask_text(), "0000000f");
  EXPECT_EQ(ScanLayout({0x5}, bytes).bytes(), 4U);
  EXPECT_EQ(ScanLayout({0x9}, bytes).bytes(), 8U);
  EXPECT_EQ(ScanLayout({0x8}, bytes).bytes(), 4U);
}

}  // namespace
}  // namespace kolsky
